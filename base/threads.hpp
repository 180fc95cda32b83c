#pragma once

#include <optional>
#include <string>

namespace taut {

// taut keeps its own number of threads and passes it to each parallel region. OpenMP's setting belongs to the
// program that taut is a part of: taut neither reads nor changes it.

// The default of the process: the number last given to use_threads() on any thread, or else OMP_NUM_THREADS
// (the first number of a list), or else one, so that no result depends on the number of cores.
// OMP_NUM_THREADS is read once, when it is first needed; throws InputError where it is no number from 1 to
// 1024. Always 1 without OpenMP. `taut run` takes threads_worth_waking() in place of that one.
int default_threads();
std::optional<int> asked_threads();  // the same; empty where no number was given
void use_threads(int threads);
void ignore_omp_num_threads();  // OMP_NUM_THREADS counts no more
bool has_threads();             // false without OpenMP

// Throws InputError, a message that begins with `what`, for a number of threads that cannot be had.
void expect_threads(const std::string& what, int threads);

// While it lives, loops that start on its thread use this number of threads in place of the default.
class ThreadScope {
 public:
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  int before_;
};

// The number of threads for a loop that starts here: that of the innermost ThreadScope, or else the default.
int available_threads();

namespace detail {
void run_on_threads(int threads, void (*work)(const void*, int), const void* argument);
}

// Calls work(t) for t = 0 … threads − 1 on as many threads, or on fewer where OMP_THREAD_LIMIT, OMP_DYNAMIC
// or an outer parallel region limit them: no t may wait for another, and results do not depend on the number
// of threads that run. All t are carried out even if some throw; the exception of the lowest t is then thrown
// here. Allocates nothing.
template <class Work>
void in_parallel(int threads, const Work& work) {
  if (threads <= 1) return work(0);
  detail::run_on_threads(
      threads, [](const void* argument, int t) { (*static_cast<const Work*>(argument))(t); }, &work);
}

// The range of n things that is the share of thread t.
struct Share {
  int begin, end;
  Share(int n, int t, int threads)
      : begin(static_cast<int>(static_cast<long>(n) * t / threads)),
        end(static_cast<int>(static_cast<long>(n) * (t + 1) / threads)) {}
};

}  // namespace taut
