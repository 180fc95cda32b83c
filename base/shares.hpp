#pragma once

#include <algorithm>

#include "base/threads.hpp"

namespace taut {

// How many threads n things are worth, where fewer than `least` are not worth waking one for.
inline int threads_for(long n, int least) {
  return static_cast<int>(std::clamp(n / least, 1L, static_cast<long>(available_threads())));
}

// work(share) of n things on so many threads.
template <class Work>
void in_shares(int n, int least, const Work& work) {
  const int threads = threads_for(n, least);
  in_parallel(threads, [&](int t) { work(Share(n, t, threads)); });
}

inline constexpr int kAtomsOfShortWork = 500;

// work(first, last + 1) of all atoms, something short with each.
template <class Work>
void by_atoms(int atoms, const Work& work) {
  in_shares(atoms, kAtomsOfShortWork, [&](const Share& share) { work(share.begin, share.end); });
}

}  // namespace taut
