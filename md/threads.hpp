#pragma once

namespace taut {

// How many threads a loop may use: what use_threads() said, else OMP_NUM_THREADS, else one: the same bits on
// every machine unless asked otherwise; 1 without OpenMP. On a machine that others use too, set
// OMP_WAIT_POLICY=passive with it: GCC's threads wait for each other spinning, and steps a hundred times
// longer were seen.
int available_threads();
void use_threads(int threads);

namespace detail {
void run_on_threads(int threads, void (*work)(const void*, int), const void* argument);
}

// work(t) for t = 0 … threads − 1, each on a thread of its own. What it does must not depend on the order.
// Must not throw. Allocates nothing.
template <class Work>
void in_parallel(int threads, const Work& work) {
  if (threads <= 1) return work(0);
  detail::run_on_threads(
      threads, [](const void* argument, int t) { (*static_cast<const Work*>(argument))(t); }, &work);
}

// The share of thread t in n things.
struct Share {
  int begin, end;
  Share(int n, int t, int threads)
      : begin(static_cast<int>(static_cast<long>(n) * t / threads)),
        end(static_cast<int>(static_cast<long>(n) * (t + 1) / threads)) {}
};

}  // namespace taut
