#pragma once

#include <vector>

namespace taut {

// How many threads the constraint methods may use: OMP_NUM_THREADS, else all cores; 1 without OpenMP.
int most_threads();

namespace detail {
void run_on_threads(int threads, void (*work)(void*, int), void* argument);
}

// Calls work(t) for t = 0 … threads − 1, each on a thread of its own. Allocates nothing.
template <class Work>
void run_on_threads(int threads, Work&& work) {
  if (threads <= 1) return work(0);
  detail::run_on_threads(
      threads, [](void* argument, int t) { (*static_cast<std::remove_reference_t<Work>*>(argument))(t); },
      &work);
}

}  // namespace taut
