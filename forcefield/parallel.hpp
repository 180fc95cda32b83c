#pragma once

#ifdef _OPENMP
#include <omp.h>
#endif

namespace taut {

// How many threads a loop may use: OMP_NUM_THREADS, and one where it is not set: the same bits on every
// machine unless asked otherwise. On a machine that others use too, set OMP_WAIT_POLICY=passive with it:
// GCC's threads wait for each other spinning, and steps a hundred times longer were seen.
int available_threads();

// work(t) for t = 0 .. threads − 1, side by side. What it does must not depend on the order. Must not throw.
template <class Work>
void in_parallel(int threads, const Work& work) {
  if (threads == 1) return work(0);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1)
#endif
  for (int t = 0; t < threads; ++t) work(t);
}

// The share of thread t in n things.
struct Share {
  int begin, end;
  Share(int n, int t, int threads)
      : begin(static_cast<int>(static_cast<long>(n) * t / threads)),
        end(static_cast<int>(static_cast<long>(n) * (t + 1) / threads)) {}
};

}  // namespace taut
