// Rows, as those behind Python's sim.log, are appended by one thread and read by others. This is compiled with a thread
// sanitizer, which reports a race and ends with 66. Alone: ninja -C build shared_rows_test && build/tests/shared_rows_test

#include "base/shared_rows.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

// Of the sanitizer: ends at the first race, which may leave threads in loops.
extern "C" const char* __tsan_default_options() {
  return "halt_on_error=1";
}

namespace taut {
namespace {

TEST(SharedRows, AreReadWhileTheyAreAppended) {
  constexpr long kRows = 20000;
  SharedRows<std::vector<long>> rows;  // with memory of their own, as rows of the log
  std::atomic<bool> begun = false;
  std::thread writer([&] {
    for (long n = 0; n < kRows; ++n) {
      rows.append({n, -n});
      begun = true;
    }
  });
  while (!begun) std::this_thread::yield();
  const auto look = [&] {
    std::size_t seen = 0;
    for (int n = 0; n < 50; ++n) {
      const auto all = rows.copy();
      EXPECT_GE(all.size(), std::max<std::size_t>(seen, 1));
      seen = all.size();
      EXPECT_EQ(all.back()[0], static_cast<long>(seen) - 1);
      EXPECT_EQ(all.back()[1], -all.back()[0]);
    }
  };
  std::vector<std::thread> readers;
  for (int n = 0; n < 2; ++n) readers.emplace_back(look);
  look();
  for (std::thread& reader : readers) reader.join();
  writer.join();
  EXPECT_EQ(rows.copy().size(), kRows);
}

}  // namespace
}  // namespace taut
