#include "md/threads.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "forcefield/clusters/row_shares.hpp"
#include "md/shares.hpp"
#include "md/thread_meter.hpp"
#include "md/work_meter.hpp"

namespace taut {
namespace {

struct Threads {
  explicit Threads(int threads) { use_threads(threads); }
  ~Threads() { use_threads(1); }
};

volatile double kept = 0;
void work(int units) {
  for (int n = 0; n < units * 20000; ++n) kept = std::sqrt(kept + n);
}

TEST(ThreadMeter, TellsWhatOneThreadDoesFromWhatTheyShare) {
  const Threads four(4);
  const ThreadMeter meter;
  work(40);
  for (int n = 0; n < 10; ++n) in_parallel(4, [](int t) { work(t == 2 ? 6 : 2); });
  const ThreadAccount a = meter.account();
  EXPECT_EQ(a.regions, 10);
  // 40 / 60 and 120 / 60, but the same work may take twice as long beside others
  EXPECT_GT(a.serial / a.longest, 0.25);
  EXPECT_LT(a.serial / a.longest, 1.8);
  EXPECT_GT(a.busy / a.longest, 1.1);
  EXPECT_LT(a.busy / a.longest, 4);
}

TEST(ThreadMeter, CountsNoRegionOfOneThread) {
  const Threads four(4);
  const ThreadMeter meter;
  in_shares(1000, 600, [](const Share&) { work(1); });
  in_shares(1200, 600, [](const Share&) { work(1); });
  EXPECT_EQ(meter.account().regions, 1);
}

// Whose sums are shared: all of them, by as many threads as there are.
TEST(WorkMeter, TakesInAllAtomsOnAnyNumberOfThreads) {
  const int atoms = 5001;
  State before{{}, Vectors::Random(3, atoms), Vectors::Random(3, atoms), 0, {}}, now = before;
  now.f.setRandom();
  const double work = 0.5 * 0.01 * (before.f + now.f).cwiseProduct(now.v).sum();
  for (const int threads : {1, 2, 5}) {
    const Threads some(threads);
    WorkMeter meter;
    meter.see(0.01, before);
    meter.see(0.01, now);
    EXPECT_NEAR(meter.work(), work, 1e-12);
    EXPECT_EQ(meter.forces(), now.f);
  }
}

// Lists of unlike lengths and rows of unlike work.
TEST(RowShares, GiveEachThreadAsMuchWorkInTheOrderOfTheRows) {
  constexpr int kThreads = 5;
  std::vector<ClusterList> lists(kThreads);
  long all = 0, longest = 0;
  for (int t = 0; t < kThreads; ++t)
    for (int r = 0; r < (t == 3 ? 0 : 40 * (t + 1)); ++r) {
      PairRow row{};
      row.end = 1 + (7 * r + t) % 11;
      row.masked_end = t == 4 ? 15 : r % 3;
      lists[t].rows.push_back(row);
      all += row.end + row.masked_end;
      longest = std::max(longest, long{row.end} + row.masked_end);
    }
  RowShares shares;
  shares.make_room(kThreads);
  for (int t = 0; t < kThreads; ++t) shares.count(t, lists[t]);
  shares.add_up();
  int list = 0, next = 0;
  for (int t = 0; t < kThreads; ++t) {
    shares.take(t, lists);
    long own = 0;
    for (const auto& [at, rows] : shares.pieces(t)) {
      while (at != list) {
        ASSERT_EQ(next, int(lists[list].rows.size()));
        ++list;
        next = 0;
      }
      ASSERT_EQ(rows.begin, next);
      for (; next < rows.end; ++next) own += lists[at].rows[next].end + lists[at].rows[next].masked_end;
    }
    EXPECT_LE(std::abs(own - all / kThreads), longest + 1) << t;
  }
  EXPECT_EQ(list, kThreads - 1);
  EXPECT_EQ(next, int(lists[kThreads - 1].rows.size()));
}

}  // namespace
}  // namespace taut
