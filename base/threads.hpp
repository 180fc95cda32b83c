#pragma once

#include <optional>
#include <string>

namespace taut {

// The number of threads is taut's own: each parallel region is told it. OpenMP's setting belongs to the
// program that taut is a part of, and is neither asked nor changed.

// The process's default: what use_threads() said last, on whatever thread, or else OMP_NUM_THREADS (of a list
// the first number), or else one, so that no result depends on how many cores a machine has. OMP_NUM_THREADS
// is read once, when it is first needed; throws InputError where it is no number from 1 to 1024. 1 without
// OpenMP.
int default_threads();
std::optional<int> asked_threads();  // the same; nothing where nobody said a number
void use_threads(int threads);

// Throws InputError, which begins with `what`, for a number of threads that cannot be had.
void expect_threads(const std::string& what, int threads);

// While it lives, loops that start on its thread share their work among so many, whatever the default is.
class ThreadScope {
 public:
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  int before_;
};

// How many threads a loop that starts here may use: as the innermost ThreadScope says, or else the default.
int available_threads();

namespace detail {
void run_on_threads(int threads, void (*work)(const void*, int), const void* argument);
}

// work(t) for t = 0 … threads − 1, side by side on as many threads as OpenMP gives: as many, or fewer where
// OMP_THREAD_LIMIT, OMP_DYNAMIC or a region around this one say so. So no t may wait for another, and results
// do not depend on how many there are. All of them are carried out; of the exceptions they throw that of the
// lowest t is then thrown here. Allocates nothing of its own.
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
