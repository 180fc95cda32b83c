#pragma once

#include <exception>
#include <vector>

namespace taut {

// Measures the parallel regions that its thread starts while it lives: the innermost one where there are several.
class RegionMeter {
 public:
  RegionMeter();
  virtual ~RegionMeter();
  RegionMeter(const RegionMeter&) = delete;
  RegionMeter& operator=(const RegionMeter&) = delete;

  // Runs a region of work(argument, t), t = 0 … threads − 1. Returns what the lowest t that failed has
  // thrown.
  virtual std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument) = 0;

 protected:
  // Runs it unmeasured.
  static std::exception_ptr run_region(int threads, const auto& work) {
    return run_region(
        threads, [](const void* of, int t) { (*static_cast<const decltype(&work)>(of))(t); }, &work);
  }

 private:
  static std::exception_ptr run_region(int threads, void (*work)(const void*, int), const void* argument);

  RegionMeter* before_;  // which goes on when this one is gone
};

// What threads did, in processor time of each thread. It does not depend on what else the machine runs, nor
// on its number of cores. A program that has its cores to itself takes
//     serial + longest + regions × (the time to wake threads and to wait for them).
struct ThreadAccount {
  long regions = 0;    // where threads worked together
  double serial = 0;   // between them, the first thread [s]
  double longest = 0;  // in each the thread with most to do, together [s]
  double busy = 0;     // all threads in them [s]
};

// Measures regions in processor time. It makes each region some 4 µs slower. The time of those clock readings that
// fall within a measured time is subtracted.
class ThreadMeter final : public RegionMeter {
 public:
  ThreadMeter();
  ThreadAccount account() const;  // so far

  std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument) override;

 private:
  double since(double start) const;  // [s]

  double reading_;  // how long it takes to read the clock [s]
  double serial_since_;
  ThreadAccount total_;
  std::vector<double> spent_;  // by t, in the region at hand [s]
};

}  // namespace taut
