#include "constraints/threads.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace taut {

#ifdef _OPENMP

int most_threads() {
  return omp_get_max_threads();
}

void detail::run_on_threads(int threads, void (*work)(void*, int), void* argument) {
#pragma omp parallel num_threads(threads)
  for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) work(argument, t);
}

#else

int most_threads() {
  return 1;
}

void detail::run_on_threads(int threads, void (*work)(void*, int), void* argument) {
  for (int t = 0; t < threads; ++t) work(argument, t);
}

#endif

}  // namespace taut
