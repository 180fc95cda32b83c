#pragma once

#include <algorithm>

#include "base/threads.hpp"

namespace taut {

// The number of threads for n things, of which each thread gets at least `least`: fewer are not worth waking
// one.
inline int threads_for(long n, int least) {
  return static_cast<int>(std::clamp(n / least, 1L, static_cast<long>(available_threads())));
}

// Calls work(share) for shares of n things, on threads_for(n, least) threads.
template <class Work>
void in_shares(int n, int least, const Work& work) {
  const int threads = threads_for(n, least);
  in_parallel(threads, [&](int t) { work(Share(n, t, threads)); });
}

inline constexpr int kAtomsOfShortWork = 500;

// Calls work(first, last + 1) for ranges of all atoms, on threads; for work of a few operations an atom.
template <class Work>
void by_atoms(int atoms, const Work& work) {
  in_shares(atoms, kAtomsOfShortWork, [&](const Share& share) { work(share.begin, share.end); });
}

}  // namespace taut
