#pragma once

#include <exception>
#include <vector>

namespace taut {

// What threads do, in processor time of each thread: as much on a machine that others use too, and with more
// threads than it has cores. A program on its own cores takes
//     serial + longest + regions × (what waking threads and waiting for them takes).
struct ThreadAccount {
  long regions = 0;    // where threads worked together
  double serial = 0;   // between them, the first thread [s]
  double longest = 0;  // in each the thread with most to do, together [s]
  double busy = 0;     // all threads in them [s]
};

// Keeps the account of the regions that its thread starts while it lives; one at a time on a thread. Each
// region is slower by some 4 µs then, of which the account takes off what it can: the readings of the clock
// that fall within its own times.
class ThreadMeter {
 public:
  ThreadMeter();
  ~ThreadMeter();
  ThreadMeter(const ThreadMeter&) = delete;
  ThreadMeter& operator=(const ThreadMeter&) = delete;
  ThreadAccount account() const;  // so far

  // A region of work(argument, t), t = 0 … threads − 1. What was thrown in it, by the lowest t.
  std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument);

 private:
  double since(double start) const;  // [s]

  double reading_;  // how long it takes to read the clock [s]
  double serial_since_;
  ThreadAccount total_;
  std::vector<double> spent_;  // by t, in the region at hand [s]
};

}  // namespace taut
