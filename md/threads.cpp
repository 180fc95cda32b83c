#include "md/threads.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <vector>

#include "md/thread_meter.hpp"

#ifdef _OPENMP
#include <omp.h>

#include <cstdlib>
#endif

namespace taut {
namespace {

double processor_time() {  // of this thread [s]
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// What two readings one after the other are apart: a call of the system's, as long as a short region.
double reading_time() {
  std::array<double, 101> apart;
  for (double& t : apart) {
    const double before = processor_time();
    t = processor_time() - before;
  }
  std::nth_element(apart.begin(), apart.begin() + 50, apart.end());
  return apart[50];
}

// Of the one meter there is.
bool metered = false;
double reading = 0;
ThreadAccount total;
double serial_since = 0;
std::vector<double> spent;  // by thread, in the region at hand

#ifdef _OPENMP
// OpenMP's own default is every core.
bool one_unless_asked() {
  if (!std::getenv("OMP_NUM_THREADS")) omp_set_num_threads(1);
  return true;
}
void start() {
  static const bool started = one_unless_asked();
  static_cast<void>(started);
}
#endif

void run(int threads, void (*work)(const void*, int), const void* argument) {
#ifdef _OPENMP
#pragma omp parallel num_threads(threads)
  for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) work(argument, t);
#else
  for (int t = 0; t < threads; ++t) work(argument, t);
#endif
}

double since(double start) {
  return std::max(0.0, processor_time() - start - reading);
}

struct Metered {
  void (*work)(const void*, int);
  const void* argument;

  static void run(const void* self, int t) {
    const auto& [work, argument] = *static_cast<const Metered*>(self);
    const double start = processor_time();
    work(argument, t);
    spent[t] = since(start);
  }
};

void run_metered(int threads, const Metered& work) {
  total.serial += since(serial_since);
  spent.assign(threads, 0);
  run(threads, Metered::run, &work);
  ++total.regions;
  total.longest += *std::max_element(spent.begin(), spent.end());
  for (const double s : spent) total.busy += s;
  serial_since = processor_time();
}

}  // namespace

#ifdef _OPENMP

int available_threads() {
  start();
  return omp_get_max_threads();
}

void use_threads(int threads) {
  start();
  omp_set_num_threads(threads);
}

#else

int available_threads() {
  return 1;
}

void use_threads(int) {}

#endif

void detail::run_on_threads(int threads, void (*work)(const void*, int), const void* argument) {
  metered ? run_metered(threads, {work, argument}) : run(threads, work, argument);
}

ThreadMeter::ThreadMeter() {
  total = {};
  metered = true;
  reading = reading_time();
  serial_since = processor_time();
}
ThreadMeter::~ThreadMeter() {
  metered = false;
}
ThreadAccount ThreadMeter::account() const {
  ThreadAccount so_far = total;
  so_far.serial += since(serial_since);
  return so_far;
}

}  // namespace taut
