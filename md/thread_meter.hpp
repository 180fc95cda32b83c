#pragma once

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

// Keeps the account while it lives; one at a time. Each region is slower by some 4 µs then, of which the
// account takes off what it can: the readings of the clock that fall within its own times.
class ThreadMeter {
 public:
  ThreadMeter();
  ~ThreadMeter();
  ThreadMeter(const ThreadMeter&) = delete;
  ThreadMeter& operator=(const ThreadMeter&) = delete;
  ThreadAccount account() const;  // so far
};

}  // namespace taut
