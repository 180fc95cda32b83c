#include "md/threads.hpp"

#ifdef _OPENMP
#include <omp.h>

#include <cstdlib>
#endif

namespace taut {

#ifdef _OPENMP

namespace {
// OpenMP's own default is every core.
bool one_unless_asked() {
  if (!std::getenv("OMP_NUM_THREADS")) omp_set_num_threads(1);
  return true;
}
void start() {
  static const bool started = one_unless_asked();
  static_cast<void>(started);
}
}  // namespace

int available_threads() {
  start();
  return omp_get_max_threads();
}

void use_threads(int threads) {
  start();
  omp_set_num_threads(threads);
}

void detail::run_on_threads(int threads, void (*work)(const void*, int), const void* argument) {
#pragma omp parallel num_threads(threads)
  for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) work(argument, t);
}

#else

int available_threads() {
  return 1;
}

void use_threads(int) {}

void detail::run_on_threads(int threads, void (*work)(const void*, int), const void* argument) {
  for (int t = 0; t < threads; ++t) work(argument, t);
}

#endif

}  // namespace taut
