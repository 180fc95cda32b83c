#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>
#include <set>
#include <utility>

#include "forcefield/neighbour_list.hpp"
#include "md/errors.hpp"

// Counts what the program allocates, for the test that a list in use allocates nothing.
static std::atomic<long> allocations{0};
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace taut {
namespace {

using PairSet = std::set<std::pair<int, int>>;

Vectors random_positions(int n, const Vec3& extent, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Vectors x(3, n);
  for (int a = 0; a < n; ++a)
    for (int d = 0; d < 3; ++d) x(d, a) = extent[d] * uniform(rng);
  return x;
}

void move_a_little(Vectors& x, double scale, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  for (int a = 0; a < x.cols(); ++a)
    for (int d = 0; d < 3; ++d) x(d, a) += scale * normal(rng);
}

// The witness: the distance of every pair, over all images that could be the nearest.
PairSet pairs_within(const Vectors& x, const Box& box, double range) {
  PairSet pairs;
  for (int i = 0; i < x.cols(); ++i)
    for (int j = i + 1; j < x.cols(); ++j) {
      double r2 = 0;
      for (int d = 0; d < 3; ++d) {
        double u = std::abs(x(d, j) - x(d, i));
        if (box.periodic()) {
          u = std::fmod(u, box.edge[d]);
          u = std::min(u, box.edge[d] - u);
        }
        r2 += u * u;
      }
      if (r2 <= range * range) pairs.emplace(i, j);
    }
  return pairs;
}

// The pairs of a list, each checked to be there only once.
PairSet listed(const PairList& list) {
  PairSet pairs;
  for (const auto& row : list.rows)
    for (int p = row.begin; p < row.end; ++p)
      EXPECT_TRUE(pairs.insert(std::minmax(int(row.atom), int(list.partners[p]))).second)
          << "a pair listed twice";
  return pairs;
}

// A listed separation is the one to the nearest image, with no more to do but in the smallest boxes.
void expect_nearest_images(const NeighbourList& list, const Vectors& x, const Box& box) {
  const Vectors& seen = list.positions();
  for (const auto& row : list.pairs()[1].rows)
    for (int p = row.begin; p < row.end; ++p) {
      const int i = row.atom, j = list.pairs()[1].partners[p];
      Vec3 d = seen.col(i) - seen.col(j) - row.shift;
      if (list.needs_images()) d = box.nearest_image(d);
      EXPECT_LT((d - box.nearest_image(x.col(i) - x.col(j))).norm(), 1e-13);
    }
}

bool contains(const PairSet& all, const PairSet& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

PairRules one_kind(int n) {
  return {std::vector<std::uint8_t>(n, 1), {}};
}

struct Case {
  const char* name;
  int atoms;
  Vec3 extent;    // filled with atoms [nm]
  bool periodic;  // the extent is a box
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class NeighbourListIn : public testing::TestWithParam<Case> {};

constexpr ListRange kRange{0.5, 0.1};  // lists reach 0.6 nm

TEST_P(NeighbourListIn, MissesNoPairWhileAtomsMove) {
  const auto& [name, n, extent, periodic] = GetParam();
  std::mt19937_64 rng(7);
  const Box box{periodic ? extent : Vec3::Zero()};
  Vectors x = random_positions(n, extent, rng);
  if (periodic)  // molecules that have drifted through the box stay unwrapped
    for (int a = 0; a < n; ++a) x.col(a) += box.edge.cwiseProduct(Vec3(a % 5 - 2, a % 3 - 1, a % 7 - 3));
  NeighbourList list(one_kind(n), box, kRange);
  int builds = 0;
  for (int step = 0; step < 25; ++step) {
    if (list.update(x)) {
      ++builds;
      EXPECT_EQ(listed(list.pairs()[1]), pairs_within(x, box, kRange.cutoff + kRange.buffer));
    }
    EXPECT_TRUE(contains(listed(list.pairs()[1]), pairs_within(x, box, kRange.cutoff))) << "at step " << step;
    expect_nearest_images(list, x, box);
    move_a_little(x, 0.008, rng);
  }
  EXPECT_GT(builds, 2);
  EXPECT_LT(builds, 20);
}

INSTANTIATE_TEST_SUITE_P(
    Spaces, NeighbourListIn,
    testing::Values(Case{"smallest", 60, {1.0, 1.0, 1.0}, true},
                    Case{"under_five_half_cells", 120, {1.4, 1.49, 2.0}, true},
                    Case{"five_half_cells", 120, {1.51, 1.6, 1.7}, true},
                    Case{"three_cells_crowded", 250, {1.81, 1.9, 2.3}, true},
                    Case{"three_cells_sparse", 60, {1.81, 1.9, 2.3}, true},
                    Case{"slab", 250, {1.3, 5.0, 5.0}, true}, Case{"large", 300, {4.0, 5.0, 6.0}, true},
                    Case{"nearly_empty", 40, {90, 90, 90}, true}, Case{"drop", 300, {2.0, 2.0, 2.0}, false},
                    Case{"thread", 300, {30.0, 0.1, 0.1}, false}, Case{"cloud", 200, {5.0, 5.0, 5.0}, false},
                    Case{"pair", 2, {0.3, 0.3, 0.3}, false}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(NeighbourList, IsRebuiltExactlyWhenAnAtomMovedOverHalfTheBuffer) {
  std::mt19937_64 rng(3);
  const Box box{Vec3(3, 3, 3)};
  Vectors x = random_positions(50, box.edge, rng);
  NeighbourList list(one_kind(50), box, kRange);
  EXPECT_TRUE(list.update(x));
  EXPECT_FALSE(list.update(x));
  const Vec3 direction = Vec3(1, -2, 2) / 3;
  const Vec3 start = x.col(17);
  x.col(17) = start + 0.0499 * direction;
  EXPECT_FALSE(list.update(x));
  x.col(17) = start - 0.0499 * direction;  // counted from the build, not from the last call
  EXPECT_FALSE(list.update(x));
  x.col(17) = start + 0.0501 * direction;
  EXPECT_TRUE(list.update(x));
  EXPECT_FALSE(list.update(x));
  x.col(17) = start + 0.01 * direction;
  EXPECT_FALSE(list.update(x));
}

TEST(NeighbourList, SortsPairsByWhatTheirAtomsShareAndLeavesExclusionsOut) {
  const int n = 120;
  std::mt19937_64 rng(5);
  for (const Box& box : {Box{}, Box{Vec3(2, 2, 2)}, Box{Vec3(1.3, 1.3, 1.3)}}) {
    const Vectors x = random_positions(n, box.periodic() ? box.edge : Vec3(2, 2, 2), rng);
    PairRules rules;
    for (int a = 0; a < n; ++a) rules.kind.push_back(static_cast<std::uint8_t>(a % 4));
    PairSet excluded;
    for (int a = 0; a + 8 < n; ++a) {
      rules.exclusions.push_back({a + 4, a});
      rules.exclusions.push_back({a, a + 8});
      excluded.insert({{a, a + 4}, {a, a + 8}});
    }
    NeighbourList list(rules, box, kRange);
    list.update(x);
    std::array<PairSet, kPairKinds> expected;
    for (const auto& pair : pairs_within(x, box, 0.6))
      if (!excluded.contains(pair)) expected[(pair.first % 4) & (pair.second % 4)].insert(pair);
    EXPECT_TRUE(list.pairs()[0].partners.empty());
    for (int kind = 1; kind < kPairKinds; ++kind) {
      EXPECT_FALSE(expected[kind].empty());
      EXPECT_EQ(listed(list.pairs()[kind]), expected[kind]);
    }
  }
}

// Distances looked at, an atom.
double search_cost(int n, const Vec3& extent, bool periodic) {
  std::mt19937_64 rng(11);
  NeighbourList list(one_kind(n), periodic ? Box{extent} : Box{}, kRange);
  list.update(random_positions(n, extent, rng));
  return double(list.candidates()) / n;
}

TEST(NeighbourList, CostsTheSameAnAtomHoweverManyThereAre) {
  for (double crowd : {1.0, 4.0}) {  // of few and of many atoms a cell
    const int n = static_cast<int>(800 * crowd);
    EXPECT_NEAR(search_cost(8 * n, {9.8, 9.8, 9.8}, true) / search_cost(n, {4.9, 4.9, 4.9}, true), 1, 0.05);
    EXPECT_NEAR(search_cost(8 * n, {9.8, 9.8, 9.8}, false) / search_cost(n, {4.9, 4.9, 4.9}, false), 1, 0.25);
  }
}

TEST(NeighbourList, StrayAtomsCostNothing) {
  const int n = 1000;
  std::mt19937_64 rng(13);
  Vectors x = random_positions(n, {6, 6, 6}, rng);
  NeighbourList list(one_kind(n), {}, kRange);
  list.update(x);
  const long before = list.candidates();
  x.col(0) = Vec3(1e6, -3e6, 2e6);
  x.col(1) = Vec3(-1e9, 1e9, 0);
  list.update(x);
  EXPECT_LE(list.candidates(), before);
  EXPECT_EQ(listed(list.pairs()[1]), pairs_within(x, {}, 0.6));

  CellList cells;
  cells.build(x, {}, 0.6);
  EXPECT_LE(cells.cells(), n);
}

TEST(NeighbourList, AllocatesNothingOnceItHasRoom) {
  const int n = 1500;
  std::mt19937_64 rng(17);
  for (const Box& box : {Box{}, Box{Vec3(4, 4, 4)}, Box{Vec3(1.2, 1.2, 1.2)}}) {
    Vectors x =
        random_positions(box.edge[0] == 1.2 ? 200 : n, box.periodic() ? box.edge : Vec3(4, 4, 4), rng);
    NeighbourList list(one_kind(static_cast<int>(x.cols())), box, kRange);
    const Vectors start = x;
    const auto wander = [&] {
      int builds = 0;
      for (int step = 0; step < 10; ++step) {
        x = start;
        std::mt19937_64 same(step);
        move_a_little(x, 0.03, same);
        builds += list.update(x);
      }
      return builds;
    };
    wander();
    const long before = allocations;
    EXPECT_EQ(wander(), 10);
    EXPECT_EQ(allocations, before);
  }
}

TEST(NeighbourList, RefusesPositionsThatAreNotFinite) {
  std::mt19937_64 rng(19);
  for (const Box& box : {Box{}, Box{Vec3(4, 4, 4)}, Box{Vec3(1.2, 1.2, 1.2)}}) {
    Vectors x = random_positions(30, Vec3(1, 1, 1), rng);
    NeighbourList list(one_kind(30), box, kRange);
    list.update(x);
    x(1, 12) = std::nan("");
    EXPECT_THROW(list.update(x), SimulationFailure);
    x(1, 12) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(list.update(x), SimulationFailure);
    x(1, 12) = 1e300;
    if (box.periodic()) continue;  // wraps
    EXPECT_THROW(list.update(x), SimulationFailure);
  }
}

}  // namespace
}  // namespace taut
