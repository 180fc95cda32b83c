#include "base/threads.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/errors.hpp"
#include "base/shares.hpp"
#include "base/usable_cores.hpp"
#include "error_message.hpp"
#include "forcefield/pairs/row_shares.hpp"
#include "md/step_parts.hpp"
#include "md/velocity_verlet.hpp"
#include "temporary_folder.hpp"

// OpenMP's own, which taut is linked with where it was built with it.
extern "C" {
int omp_get_max_threads() __attribute__((weak));
void omp_set_num_threads(int threads) __attribute__((weak));
int omp_get_num_threads() __attribute__((weak));
}

namespace taut::threads_tests {
namespace {

struct Threads {
  explicit Threads(int threads) { use_threads(threads); }
  ~Threads() { use_threads(1); }
};

// What `ask` says on a thread that has nothing to do with this one.
template <class Ask>
auto elsewhere(const Ask& ask) {
  std::optional<decltype(ask())> answer;
  std::thread([&] { answer = ask(); }).join();
  return *answer;
}

// A program with OpenMP of its own, which told it to use five threads, and calls taut.
TEST(NumberOfThreads, LeavesOpenMPAsTheHostSetIt) {
  if (omp_get_max_threads == nullptr) GTEST_SKIP() << "built without OpenMP";
  const Threads restored(1);
  const auto host_has = [] { return omp_get_max_threads(); };
  const int at_first = host_has(), at_first_elsewhere = elsewhere(host_has);
  omp_set_num_threads(5);
  EXPECT_EQ(available_threads(), 1);
  EXPECT_EQ(host_has(), 5);
  use_threads(2);
  in_parallel(3, [](int) {});
  EXPECT_EQ(host_has(), 5);
  {
    const ThreadScope scope(4);
    in_shares(8, 1, [](const Share&) {});
    EXPECT_EQ(host_has(), 5);
  }
  EXPECT_EQ(elsewhere(host_has), at_first_elsewhere);
  EXPECT_EQ(available_threads(), 2);
  omp_set_num_threads(at_first);
}

TEST(NumberOfThreads, IsOneDefaultForAllThreadsOfTheHost) {
  const Threads three(3);
  EXPECT_EQ(available_threads(), 3);
  EXPECT_EQ(elsewhere(available_threads), 3);
  std::thread([] { use_threads(2); }).join();
  EXPECT_EQ(available_threads(), 2);
  EXPECT_EQ(asked_threads(), 2);
}

TEST(NumberOfThreads, IsItsOwnWithinAScopeAndOnItsThreadAlone) {
  const Threads two(2);
  {
    const ThreadScope scope(5);
    EXPECT_EQ(available_threads(), 5);
    EXPECT_EQ(elsewhere(available_threads), 2);
    EXPECT_EQ(default_threads(), 2);
    {
      const ThreadScope inner(3);
      EXPECT_EQ(available_threads(), 3);
      EXPECT_EQ(threads_for(1000, 100), 3);
    }
    use_threads(4);
    EXPECT_EQ(available_threads(), 5);
  }
  EXPECT_EQ(available_threads(), 4);
}

TEST(NumberOfThreads, ThatCannotBeHadIsRefused) {
  const auto refusal = [](int threads) -> std::string {
    return error_message([&] { expect_threads("--threads", threads); });
  };
  EXPECT_EQ(refusal(1), "no error");
  EXPECT_EQ(refusal(0), "--threads: expected 1 to 1024 threads, got 0");
  EXPECT_EQ(refusal(1025), "--threads: expected 1 to 1024 threads, got 1025");
}

// Within a region OpenMP gives one thread unless it is asked for regions in regions.
TEST(InParallel, CarriesOutAllWorkWhereItGetsFewerThreads) {
  std::array<std::array<std::atomic<int>, 5>, 3> done{};
  in_parallel(3, [&](int outer) { in_parallel(5, [&](int inner) { ++done[outer][inner]; }); });
  for (const auto& row : done)
    for (const auto& times : row) EXPECT_EQ(times, 1);
}

// g++'s OpenMP would end two of the four, and start others.
TEST(InParallel, KeepsThreadsThatARegionDoesNotNeed) {
  if (omp_get_num_threads == nullptr) GTEST_SKIP() << "built without OpenMP";
  static std::atomic<int> threads_met = 0;
  const auto region = [](int threads) {
    in_parallel(threads, [](int) {
      thread_local const int number = ++threads_met;
      (void)number;
    });
  };
  const ThreadScope scope(4);
  for (const int threads : {4, 2, 1, 3, 4}) region(threads);
  EXPECT_EQ(threads_met, 4);
  const ThreadScope fewer(3);
  in_parallel(2, [](int) { EXPECT_EQ(omp_get_num_threads(), 3) << "as many as may be used"; });
}

// Whichever thread is first: again and again, metered and not.
TEST(InParallel, ThrowsOnWhatTheLowestOfItsThreadsThrew) {
  std::optional<PartMeter> meter;
  for (const bool metered : {false, true}) {
    if (metered) meter.emplace(4, PartMeter::Parts::kAll);
    for (int n = 0; n < 200; ++n) {
      std::atomic<int> done = 0;
      EXPECT_EQ(error_message([&] {
                  in_parallel(4, [&](int t) {
                    ++done;
                    if (t == 1) throw InputError("of one");
                    if (t == 3) throw std::bad_alloc();
                    if (t == 2) throw 2;
                  });
                }),
                "of one");
      EXPECT_EQ(done, 4);
    }
  }
  EXPECT_THROW(in_parallel(2,
                           [](int t) {
                             if (t == 1) throw std::bad_alloc();
                           }),
               std::bad_alloc);
  std::atomic<int> done = 0;
  in_parallel(4, [&](int) { ++done; });
  EXPECT_EQ(done, 4);
}

TEST(InParallel, ThrowsInTheHostsOtherThreadsToo) {
  EXPECT_TRUE(elsewhere([] {
    try {
      in_parallel(3, [](int) { throw std::bad_alloc(); });
    } catch (const std::bad_alloc&) {
      return true;
    }
    return false;
  }));
}

// Whose sums are shared out: all of them, by as many threads as there are.
TEST(Account, TakesInAllAtomsOnAnyNumberOfThreads) {
  const int atoms = 5001;
  const System sys = make_system(Eigen::VectorXd::Ones(atoms), {});
  struct Given : ForceLaw {
    Vectors f;
    void evaluate(const System&, State& s) override { s.f = f; }
  } forces;
  ConstraintMethod free;
  for (const int threads : {1, 2, 5}) {
    const Threads some(threads);
    State s{Vectors::Random(3, atoms), Vectors::Random(3, atoms), {}, 0, {}};
    VelocityVerlet verlet;
    forces.f.setRandom(3, atoms);
    verlet.initialize({sys, forces, free}, 0.01, s);
    const State before = s;
    forces.f.setRandom();
    EXPECT_TRUE(verlet.advance({sys, forces, free}, 0.01, s).converged());
    EXPECT_NEAR(verlet.account.work, 0.5 * (before.f + s.f).cwiseProduct(s.x - before.x).sum(), 1e-12);
    EXPECT_EQ(s.F, forces.f);
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
    for (const auto& [at, rows] : shares.stretches(t)) {
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

// A tree in place of /proc and /sys.
struct Machine {
  TemporaryFolder folder;

  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((folder.path() / file).parent_path());
    std::ofstream(folder.path() / file) << text;
  }
  std::optional<double> quota() const { return core_quota(folder.path()); }
};

TEST(UsableCores, AreAtMostThoseOfTheControlGroup) {
  const Machine second;
  EXPECT_FALSE(second.quota()) << "neither /proc nor /sys";
  second.write("proc/self/cgroup", "0::/user/job\n");
  second.write("sys/fs/cgroup/user/job/cpu.max", "max 100000\n");
  EXPECT_FALSE(second.quota());
  second.write("sys/fs/cgroup/user/cpu.max", "350000 100000\n");
  EXPECT_EQ(second.quota(), 3.5) << "of a group above";
  second.write("sys/fs/cgroup/user/job/cpu.max", "50000 100000\n");
  EXPECT_EQ(second.quota(), 0.5);
  second.write("sys/fs/cgroup/user/job/cpu.max", "nonsense");
  EXPECT_EQ(second.quota(), 3.5);

  const Machine container;  // its own group is the top of what it sees
  container.write("proc/self/cgroup", "0::/\n");
  container.write("sys/fs/cgroup/cpu.max", "200000 100000\n");
  EXPECT_EQ(container.quota(), 2);

  const Machine first;
  first.write("proc/self/cgroup", "5:memory:/m\n4:cpu,cpuacct:/job\n");
  first.write("sys/fs/cgroup/cpu/job/cpu.cfs_quota_us", "-1");
  first.write("sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "100000");
  EXPECT_FALSE(first.quota());
  first.write("sys/fs/cgroup/cpu/cpu.cfs_quota_us", "250000");
  first.write("sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000");
  EXPECT_EQ(first.quota(), 2.5);
}

// As taskset or a queue binds it.
TEST(UsableCores, AreAtMostThoseOfTheAffinityMask) {
  cpu_set_t before, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  CPU_ZERO(&one);
  for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu)
    if (CPU_ISSET(cpu, &before)) CPU_SET(cpu, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(usable_cores(), 1);
  EXPECT_EQ(threads_worth_waking(1000000), 1);
  sched_setaffinity(0, sizeof before, &before);
  EXPECT_LE(usable_cores(), CPU_COUNT(&before));
  EXPECT_EQ(threads_worth_waking(0), 1);
  EXPECT_EQ(threads_worth_waking(1999), 1) << "one for every thousand atoms";
  EXPECT_EQ(threads_worth_waking(2000), std::min(2, usable_cores()));
}

}  // namespace
}  // namespace taut::threads_tests
