#pragma once

#include <exception>

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

}  // namespace taut
