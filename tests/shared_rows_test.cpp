// Rows are appended by one thread and read by another. It is compiled with a thread sanitizer, which reports a race
// and ends with 66.

#include "base/shared_rows.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

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
  std::size_t seen = 0;
  for (int look = 0; look < 50; ++look) {
    const auto all = rows.copy();
    EXPECT_GE(all.size(), std::max<std::size_t>(seen, 1));
    seen = all.size();
    EXPECT_EQ(all.back()[0], static_cast<long>(seen) - 1);
    EXPECT_EQ(all.back()[1], -all.back()[0]);
  }
  writer.join();
  EXPECT_EQ(rows.copy().size(), kRows);
}

}  // namespace
}  // namespace taut
