#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "base/threads.hpp"

namespace taut::tests {

// Runs a test with the kernels of each kind of machine that they are compiled for and that this one can be:
// its own, and those with less.
template <class Test>
void on_every_machine(const Test& test) {
  struct Restored {
    ~Restored() { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); }
  } restored;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets() & ~(target - 1));  // better ones have lower bits
    test();
  }
}

// And on one thread, two and three.
template <class Test>
void on_one_to_three_threads(const Test& test) {
  struct Restored {
    ~Restored() { use_threads(1); }
  } restored;
  for (const int threads : {1, 2, 3}) {
    SCOPED_TRACE(threads);
    use_threads(threads);
    test();
  }
}

}  // namespace taut::tests
