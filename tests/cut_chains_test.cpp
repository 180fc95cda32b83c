// Long chains, cut into pieces that are solved side by side.

#include "against_plain.hpp"
#include "base/threads.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/batch/batched_lincs.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "constraints/batch/batched_sweeps.hpp"
#include "constraints/elimination.hpp"
#include "constraints/methods/settle.hpp"
#include "reference/paper_settle.hpp"

namespace taut::cut_chains_tests {
namespace {

// A chain of the masses 1, 2, 4, 1, 2, 4, …, its ends of their own, and lengths that repeat likewise.
Start copolymer(int beads, std::uint64_t seed) {
  Start start = tests::free_chain(beads, seed);
  Eigen::VectorXd mass(beads);
  for (int a = 0; a < beads; ++a) mass[a] = 1 << (a % 3);
  mass[0] = mass[beads - 1] = 7;
  auto bonds = start.system.bonds;
  for (int k = 0; k + 1 < beads; ++k) {
    bonds[k].length = k % 3 == 1 ? 1.25 : 1.0;
    start.state.x.rightCols(beads - 1 - k).colwise() +=
        (bonds[k].length - 1) * (start.state.x.col(k + 1) - start.state.x.col(k)).normalized();
  }
  start.system = make_system(mass, bonds);
  return start;
}

// All but straight: what one end of a piece does the other feels, where a coil's bonds forget within a few.
Start nearly_straight(int beads, std::uint64_t seed) {
  Start start = tests::free_chain(beads, seed);
  Random random(seed);
  for (int a = 1; a < beads; ++a)
    start.state.x.col(a) =
        start.state.x.col(a - 1) + (Vec3(1, 0, 0) + 0.05 * random.normal_vector()).normalized();
  start.state.v *= 0.1;
  return start;
}

// Chains of 8 to 64 atoms, no two of one length.
Start many_lengths() {
  std::vector<Start> all;
  for (int n = 0; n < 20; ++n) all.push_back(tests::free_chain(8 + (7 * n) % 57, 50 + n));
  return together(all);
}

// Chains that are cut into pieces: such as divide and such as do not, alone and not, of several pieces a
// lane, numbered along and not.
std::vector<std::pair<const char*, Start>> long_chains() {
  std::vector<int> odd_and_even(302);
  for (int a = 0; a < 302; ++a) odd_and_even[a] = a % 2 == 0 ? a / 2 : 151 + a / 2;
  return {{"201 bonds", tests::free_chain(202, 1)},
          {"255 bonds", tests::free_chain(256, 2)},
          {"1000 bonds", tests::free_chain(1001, 3)},
          {"3 chains of 467 bonds and a dumbbell",
           together({tests::free_chain(468, 4), tests::free_chain(468, 5), tests::free_chain(2, 6),
                     tests::free_chain(468, 7)})},
          {"chains of 301 and of 222", together({tests::free_chain(302, 4), tests::free_chain(223, 5)})},
          {"a copolymer", copolymer(400, 8)},
          {"scattered atoms", together({tests::free_chain(302, 9)}, odd_and_even)},
          {"all but straight", nearly_straight(202, 11)},
          {"chains of many lengths", many_lengths()},
          {"2600 bonds", tests::free_chain(2601, 10)}};
}

void compare_long(const MethodOptions& options, double tolerance) {
  for (const auto& [name, start] : long_chains()) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(find_clusters(start.system, ClusterLimits::cutting()).rest.empty());
    EXPECT_FALSE(find_clusters(start.system, ClusterLimits::cutting()).chains.empty());
    compare(start, options, tolerance);
  }
}

TEST(CutChains, SolveAsThePlainMethods) {
  compare_long(Baumgarte::Options{}, 1e-12);
  for (int order : {0, 2}) compare_long(Feedforward::Options{.extrapolation = order}, 1e-12);
  compare_long(Newton::Options{.tolerance = 1e-12}, 3e-12);
}

// However many threads there are while a method is made and while it works, the bits are the same: chains
// that are cut and such as are left whole, whose number lanes or threads might have a say in.
TEST(CutChains, TheSameBitsOnAnyNumberOfThreads) {
  constexpr double h = 0.001;
  for (const auto& [count, beads] :
       {std::pair{1, 10001}, std::pair{3, 1201}, std::pair{8, 401}, std::pair{12, 401}}) {
    const Start start = together(chains(count, beads, 40), {}, 0);
    for (const char* name : {"newton", "feedforward", "baumgarte", "rattle"}) {
      if (count > 1 && name == std::string_view("rattle")) continue;
      std::vector<State> ends;
      on_one_to_three_threads([&] {
        tests::NoForce forces;
        const auto method = make_method(start.system, default_options(name), h);
        State& end = ends.emplace_back(start.state);
        initialize({start.system, forces, *method}, h, end);
        for (int n = 0; n < 3; ++n) ASSERT_TRUE(step({start.system, forces, *method}, h, end).converged());
      });
      for (const State& end : ends) {
        EXPECT_EQ(end.x, ends[0].x) << count << " chains under " << name;
        EXPECT_EQ(end.v, ends[0].v) << count << " chains under " << name;
      }
    }
  }
}

TEST(CutChains, ACopyGoesOnAsTheOriginal) {
  constexpr double h = 0.001;
  const Start start = tests::free_chain(1001, 1);
  tests::NoForce forces;
  on_every_machine([&] {
    Batched<Newton> method(start.system, {}, h);
    State s = start.state;
    initialize({start.system, forces, method}, h, s);
    EXPECT_TRUE(step({start.system, forces, method}, h, s).converged());
    Batched<Newton> copy = method;
    State t = s;
    EXPECT_TRUE(step({start.system, forces, method}, h, s).converged());
    EXPECT_TRUE(step({start.system, forces, copy}, h, t).converged());
    EXPECT_EQ(s.x, t.x);
    EXPECT_EQ(s.v, t.v);
  });
}

TEST(CutChains, NameTheBondThatTurnedTooFar) {
  for (int bond : {3, 128, 129, 130, 131, 132, 133, 134, 135, 499}) {
    Start start = tests::free_chain(501, 1);
    start.state.v.setZero();
    start.state.v.col(bond) = Vec3(1e4, 0, 0);
    for (const char* name : {"newton", "feedforward"}) {
      SCOPED_TRACE(name);
      const SolveStats stats = start_and_step(start.system, default_options(name), 0.01, start.state);
      EXPECT_FALSE(stats.converged());
      EXPECT_NEAR(stats.worst_bond, bond, 40);
    }
  }
}

TEST(CutChains, AreEightTimesAsManyEqualPiecesAndTwoEnds) {
  const BondClusters found = find_clusters(tests::free_chain(2601, 1).system, ClusterLimits::cutting());
  ASSERT_EQ(found.chains.size(), 1u);
  ASSERT_EQ(found.chains[0].size(), 18u);
  ASSERT_EQ(found.pieces.size(), 3u);
  EXPECT_EQ(found.pieces[1].count, 16);
  int own = 0;
  for (const ClusterBatch& batch : found.pieces)
    own += batch.count * (batch.shape.atoms() - batch.shape.left - batch.shape.right);
  EXPECT_EQ(own, 2601);
  EXPECT_TRUE(found.rest.empty());
}

// Of 20 chains the pieces between the ends are of one shape, and fill the lanes of whichever chain they are.
TEST(CutChains, HaveOneWidthWhereLengthsAreMany) {
  const Start start = many_lengths();
  const BondClusters found = find_clusters(start.system, ClusterLimits::cutting());
  EXPECT_EQ(found.chains.size(), 20u);
  EXPECT_TRUE(found.batches.empty());
  EXPECT_TRUE(found.rest.empty());
  int inner_shapes = 0, own = 0;
  for (const ClusterBatch& batch : found.pieces) {
    inner_shapes += batch.shape.left > 0 && batch.shape.right > 0;
    own += batch.count * (batch.shape.atoms() - batch.shape.left - batch.shape.right);
  }
  EXPECT_EQ(inner_shapes, 1);
  EXPECT_EQ(own, start.system.atoms());
  // Fewer than 8 such chains stay whole, and so do chains of one length that fill the lanes.
  const Start few = together({tests::free_chain(30, 1), tests::free_chain(40, 2), tests::free_chain(50, 3)});
  EXPECT_EQ(find_clusters(few.system, ClusterLimits::cutting()).batches.size(), 3u);
  const Start equal = together(chains(16, 40, 1));
  EXPECT_EQ(find_clusters(equal.system, ClusterLimits::cutting()).batches.size(), 1u);
}

// Masses or lengths that do not repeat, or a branch: left to the plain method.
TEST(CutChains, MustRepeat) {
  const Start chain = tests::free_chain(400, 1);
  const auto left_whole = [](const Start& start) {
    const BondClusters found = find_clusters(start.system, ClusterLimits::cutting());
    EXPECT_EQ(static_cast<int>(found.rest.size()), start.system.bond_count());
    compare(start, Baumgarte::Options{}, 1e-12);
  };
  Start heavier = chain;
  Eigen::VectorXd mass = chain.system.mass;
  mass[200] = 3;
  heavier.system = make_system(mass, chain.system.bonds);
  left_whole(heavier);

  Start longer = chain;
  auto bonds = longer.system.bonds;
  bonds[200].length = 1.5;
  longer.state.x.rightCols(199).colwise() += 0.5 * Vec3(chain.state.x.col(201) - chain.state.x.col(200));
  longer.system = make_system(longer.system.mass, bonds);
  left_whole(longer);

  Start branched = chain;
  bonds = branched.system.bonds;
  bonds.back() = {200, 399, 1.0};
  branched.state.x.col(399) = chain.state.x.col(200) + Vec3(0, 0, 1);
  branched.system = make_system(branched.system.mass, bonds);
  left_whole(branched);
}

// Enough bonds for three threads, in batches of two shapes so that a thread's share ends inside one of them.
TEST(Batched, SharesOfThreadsFitTogether) {
  std::vector<Start> many = chains(300, 21, 200);
  for (Start& start : chains(500, 8, 600)) many.push_back(std::move(start));
  for (Start& start : many) start.state.x.colwise() -= start.state.x.col(0).eval();
  const Start start = together(many, {}, 0);
  Start waters = tests::waters(2100, 3, 300);
  for (int w = 0; w < 2100; ++w)
    waters.state.x.middleCols<3>(3 * w).colwise() -= waters.state.x.col(3 * w).eval();
  on_one_to_three_threads([&] {
    compare_here(start, Newton::Options{.tolerance = 1e-12}, 3e-12);
    compare_here(start, Baumgarte::Options{}, 1e-12);
    compare_here(start, Feedforward::Options{}, 1e-12);
    compare_here(start, Rattle::Options{{.sweeps = 3}}, 1e-12);
    compare_here(start, Lincs::Options{}, 1e-12);
    Settle settle(waters.system, {}, 0.001);
    tests::PaperSettle paper(waters.system);
    compare_here(waters, settle, paper, 1e-12);
  });
}

}  // namespace
}  // namespace taut::cut_chains_tests
