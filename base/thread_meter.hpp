#pragma once

#include <exception>
#include <vector>

namespace taut {

// What threads did, in processor time of each thread. It does not depend on what else the machine runs, nor
// on its number of cores. A program that has its cores to itself takes
//     serial + longest + regions × (the time to wake threads and to wait for them).
struct ThreadAccount {
  long regions = 0;    // where threads worked together
  double serial = 0;   // between them, the first thread [s]
  double longest = 0;  // in each the thread with most to do, together [s]
  double busy = 0;     // all threads in them [s]
};

// Measures the parallel regions that its thread starts while it lives; there may be one meter at a time on a
// thread. It makes each region some 4 µs slower. The time of those clock readings that fall within a measured
// time is subtracted.
class ThreadMeter {
 public:
  ThreadMeter();
  ~ThreadMeter();
  ThreadMeter(const ThreadMeter&) = delete;
  ThreadMeter& operator=(const ThreadMeter&) = delete;
  ThreadAccount account() const;  // so far

  // Runs a region of work(argument, t), t = 0 … threads − 1. Returns what the lowest t that failed has
  // thrown.
  std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument);

 private:
  double since(double start) const;  // [s]

  double reading_;  // how long it takes to read the clock [s]
  double serial_since_;
  ThreadAccount total_;
  std::vector<double> spent_;  // by t, in the region at hand [s]
};

}  // namespace taut
