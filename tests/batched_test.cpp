// The fast forms, in lanes and by threads, against the plain ones.

#include <atomic>

#include "against_plain.hpp"
#include "base/threads.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/batch/batched_lincs.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "constraints/batch/batched_sweeps.hpp"
#include "constraints/elimination.hpp"
#include "constraints/methods/settle.hpp"
#include "molecules_of_all_sorts.hpp"
#include "reference/paper_settle.hpp"

namespace taut::batched_tests {
namespace {

// Every number of lanes left over, atoms that follow each other and atoms that do not.
std::vector<std::pair<const char*, Start>> cases() {
  const Start mixed = together({tests::waters(3, 1, 300), tests::free_chain(4, 2), tests::rotor(2)});
  std::vector<int> odd_and_even(40);
  for (int a = 0; a < 40; ++a) odd_and_even[a] = a % 2 == 0 ? a / 2 : 20 + a / 2;
  return {{"one chain", tests::free_chain(20, 1)},
          {"eleven chains of 20", together(chains(11, 21, 1))},
          {"five long chains", together(chains(5, 231, 90))},
          {"thirteen dumbbells", together(chains(13, 2, 3))},
          {"chains with scattered atoms", together(chains(10, 4, 5), odd_and_even)},
          {"chains with bonds out of order", together(renumbered(chains(9, 8, 6)))},
          {"rings with and without an arm", together(rings(10))},
          {"trees", together(trees(9))},
          {"stars", together(stars(9))},
          {"dumbbells of all sorts", together(dumbbells_of_all_sorts())},
          {"waters", tests::waters(21, 3, 300)},
          {"waters apart", together(apart(waters_alike(10, {15.99943, 1.007947, 1.007947})))},
          {"waters of three masses", together(waters_alike(10, {15.99943, 2.014, 1.007947}))},
          {"pinned chains", together(pinned_chains(3))},
          {"two chains from one anchor", from_one_anchor()},
          {"pinned chains between free ones",
           together(between(chains(9, 4, 5), pinned_chains(2), chains(3, 6, 8)))},
          {"mixed", mixed}};
}

void compare_all(const MethodOptions& options, double tolerance) {
  for (const auto& [name, start] : cases()) {
    SCOPED_TRACE(name);
    compare(start, options, tolerance);
  }
}

TEST(Batched, NoneIsThePlainNone) {
  compare_all(default_options("none"), 1e-12);
}

TEST(Batched, BaumgarteIsThePlainBaumgarte) {
  // A tolerance at which no group alone takes a second solve, which the plain form takes for all.
  for (int order : {0, 1, 2}) {
    compare_all(Feedforward::Options{.tolerance = 1e-5, .extrapolation = order}, 1e-12);
    compare_all(Baumgarte::Options{.gains = "numbers",
                                   .alpha_per_ps = 300,
                                   .beta_per_ps = 900,
                                   .tolerance = 1e-5,
                                   .extrapolation = order},
                1e-12);
  }
  compare_all(Baumgarte::Options{.gains = "physical", .tolerance = 1e-13}, 1e-12);
  compare_all(Baumgarte::Options{.damping = "centred"}, 1e-12);
  compare_all(Baumgarte::Options{.sweeps = 3}, 1e-12);
}

// A step of another length has terms of its own.
TEST(Batched, BaumgarteTakesStepsOfAnyLength) {
  const Start start = together({tests::waters(9, 3, 300), tests::free_chain(4, 2)});
  for (const char* damping : {"discrete", "implicit"}) {
    SCOPED_TRACE(damping);
    const Baumgarte::Options options{
        .gains = "numbers", .damping = damping, .alpha_per_ps = 300, .beta_per_ps = 900, .tolerance = 1e-12};
    Batched<Baumgarte> fast(start.system, options, 1e-3);
    Baumgarte plain(start.system, options, 1e-3);
    State a = start.state, b = start.state;
    tests::NoForce forces;
    for (const double h : {1e-3, 5e-4, 1e-3}) {
      EXPECT_TRUE(step({start.system, forces, fast}, h, a).converged());
      EXPECT_TRUE(step({start.system, forces, plain}, h, b).converged());
      EXPECT_LT((a.f - b.f).cwiseAbs().maxCoeff(), 1e-9 * b.f.cwiseAbs().maxCoeff());
    }
  }
}

// As many sweeps as the slowest cluster takes, wherever it stands, and as many solves.
TEST(Batched, CountsWhatTheSlowestClusterTook) {
  for (const int hot : {0, 5, 19}) {
    std::vector<Start> many = chains(20, 4, 3);
    for (Start& start : many) start.state.v *= 0.01;
    many[hot].state.v *= 1000;
    const Start start = together(many);
    tests::NoForce forces;
    const auto iterations = [&](auto method) {
      State s = start.state;
      initialize({start.system, forces, method}, 0.01, s);
      return step({start.system, forces, method}, 0.01, s).iterations;
    };
    const auto same = [&](auto fast, auto plain) {
      const long want = iterations(plain);
      EXPECT_GT(want, 2);
      EXPECT_EQ(iterations(fast), want);
    };
    same(Batched<Rattle>(start.system, {}, 0.01), Rattle(start.system, {}, 0.01));
    same(Batched<Newton>(start.system, {}, 0.01), Newton(start.system, {}, 0.01));
  }
}

// After blows of every size feedforward solves as often, wherever the tolerance lies.
TEST(Batched, FeedforwardSolvesAsOftenAsThePlainOne) {
  const Start start = tests::rotor(1);
  tests::NoForce forces;
  long most = 0;
  for (double blow = 1e-3; blow < 30; blow *= 1.3) {
    const auto solves = [&](auto method) {
      State s = start.state;
      initialize({start.system, forces, method}, 0.01, s);
      s.v(1, 1) += blow;
      return step({start.system, forces, method}, 0.01, s).iterations;
    };
    const long want = solves(Baumgarte(start.system, Feedforward::Options{}, 0.01));
    EXPECT_EQ(solves(Batched<Baumgarte>(start.system, Feedforward::Options{}, 0.01)), want) << blow;
    most = std::max(most, want);
  }
  EXPECT_GT(most, 2);
}

// Iterated methods agree to what their tolerance leaves.
TEST(Batched, NewtonIsThePlainNewton) {
  compare_all(Newton::Options{.tolerance = 1e-12}, 3e-12);
}

TEST(Batched, RattleIsThePlainRattle) {
  compare_all(Rattle::Options{{.tolerance = 1e-12}}, 3e-12);
  compare_all(Rattle::Options{{.sweeps = 3}}, 1e-12);
  compare_all(Rattle::Options{{.tolerance = 1e-6}, false}, 1e-12);
}

TEST(Batched, ShakeIsThePlainShake) {
  compare_all(Shake::Options{{.tolerance = 1e-12}}, 3e-12);
  compare_all(Shake::Options{{.sweeps = 2}}, 1e-12);
}

TEST(Batched, LincsIsThePlainLincs) {
  compare_all(Lincs::Options{}, 1e-12);
  compare_all(Lincs::Options{.order = 0, .iterations = 0}, 1e-12);
  compare_all(Lincs::Options{.order = 7, .iterations = 3}, 1e-12);
}

TEST(Batched, SettleIsThePapersSettle) {
  const auto compare_with_paper = [](const Start& start) {
    on_every_machine([&] {
      Settle settle(start.system, {}, 0.001);
      tests::PaperSettle paper(start.system);
      compare_here(start, settle, paper, 1e-12);
    });
  };
  for (int count : {1, 8, 21}) compare_with_paper(tests::waters(count, 3, 300));
  compare_with_paper(together(apart(waters_alike(10, {15.99943, 1.007947, 1.007947}))));
  // hydrogens first
  std::vector<int> turned;
  for (int w = 0; w < 9; ++w) turned.insert(turned.end(), {3 * w + 2, 3 * w, 3 * w + 1});
  compare_with_paper(together({tests::waters(9, 3, 300)}, turned));
}

TEST(Batched, NamesTheBondThatTurnedTooFarInItsLane) {
  std::vector<Start> dumbbells = chains(11, 2, 3);
  dumbbells[9].state.v *= 1e3;
  const Start start = together(dumbbells);
  on_every_machine([&] {
    for (const char* name : {"newton", "rattle", "shake", "feedforward"}) {
      SCOPED_TRACE(name);
      const SolveStats stats = start_and_step(start.system, default_options(name), 0.01, start.state);
      EXPECT_FALSE(stats.converged());
      EXPECT_EQ(stats.worst_bond, 9);
    }
  });
}

TEST(Batched, NamesTheWaterThatTurnedTooFar) {
  for (const int water : {0, 9, 20}) {
    Start start = tests::waters(21, 3, 300);
    start.state.v.col(3 * water + 1) += Vec3(1e3, 0, 0);
    start.state.x += 0.001 * start.state.v;
    const SolveStats stats =
        Settle(start.system, {}, 0.001).project_positions(start.system, 0.001, start.state);
    EXPECT_FALSE(stats.converged());
    EXPECT_EQ(stats.worst_bond, 3 * water);
  }
}

// Bonds that hold, but less well than to round-off, then one that does not: it needs more iterations than
// there are, or flies off at once. On as many threads as there are groups, and not.
TEST(Batched, BlamesTheBondThatFailedNotTheOneBefore) {
  const int count = 3000, guilty = 2500;
  const std::vector<MethodOptions> limited = {Newton::Options{.tolerance = 1e-6, .max_iterations = 2},
                                              Rattle::Options{{.tolerance = 1e-6, .max_sweeps = 3}},
                                              Shake::Options{{.tolerance = 1e-6, .max_sweeps = 3}}};
  for (const double speed : {30.0, 1e5}) {
    std::vector<Start> dumbbells = chains(count, 2, 3);
    for (int c = 0; c < count; ++c) {
      dumbbells[c].state.v *= c == guilty ? speed : 0.3;
      dumbbells[c].state.x.colwise() -= dumbbells[c].state.x.col(0).eval();
    }
    const Start start = together(dumbbells, {}, 0);
    for (const int threads : {1, 3})
      for (const MethodOptions& options : limited) {
        SCOPED_TRACE(options.name());
        use_threads(threads);
        const SolveStats stats = start_and_step(start.system, options, 0.01, start.state);
        EXPECT_FALSE(stats.converged());
        EXPECT_EQ(stats.worst_bond, guilty);
        EXPECT_GT(stats.max_residual, 1e-6);
      }
  }
  use_threads(1);
}

// Bonds in lanes and bonds left to the plain method, numbered through.
TEST(Batched, NamesTheBondThatTurnedTooFarAmongThoseLeftOver) {
  std::vector<Start> parts = between(chains(9, 4, 5), pinned_chains(1), chains(3, 6, 8));
  parts[9].state.v *= 1e-3;
  parts[9].state.v.col(4) = Vec3(1e3, 1e3, 1e3);
  const Start start = together(parts);
  for (const char* name : {"newton", "rattle", "shake", "feedforward"}) {
    SCOPED_TRACE(name);
    const SolveStats stats = start_and_step(start.system, default_options(name), 0.002, start.state);
    EXPECT_FALSE(stats.converged());
    EXPECT_NEAR(stats.worst_bond, 9 * 3 + 2.5, 1.5);
  }
}

// Three bonds in a row on one line, the 1–3 distance held too: A is singular.
TEST(Batched, NamesABondOfTheClusterThatDependsOnOthers) {
  Start line = tests::free_chain(3, 1);
  line.state.x << 0, 1, 2, 0, 0, 0, 0, 0, 0;
  line.system = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}, {1, 2, 1}, {0, 2, 2}});
  Start start = together({tests::free_chain(4, 2), line});
  on_every_machine([&] {
    Batched<Baumgarte> method(start.system, {}, 0.01);
    State s = start.state;
    const SolveStats stats = method.add_forces(start.system, Push::between_steps(0.01), s);
    EXPECT_EQ(stats.failure, Failure::kSingularOrTurned);
    EXPECT_GE(stats.worst_bond, 3);
  });
}

// ... and of the one cluster among others of its shape, bent, that lies in a line.
TEST(Batched, NamesTheClusterInWhichABondDependsOnOthers) {
  std::vector<Start> triangles = chains(9, 3, 1);
  for (std::size_t c = 0; c < triangles.size(); ++c) {
    triangles[c].state.x << 0, 1, 2, 0, c == 6 ? 0 : 0.5, 0, 0, 0, 0;
    const double side = std::sqrt(1.25);
    triangles[c].system = make_system(Eigen::VectorXd::Ones(3), {{0, 1, side}, {1, 2, side}, {0, 2, 2}});
  }
  Start start = together(triangles);
  Batched<Baumgarte> method(start.system, {}, 0.01);
  const SolveStats stats = method.add_forces(start.system, Push::between_steps(0.01), start.state);
  EXPECT_EQ(stats.failure, Failure::kSingularOrTurned);
  EXPECT_EQ(stats.worst_bond / 3, 6);
}

TEST(Batched, ANaNIsTheWorstResidual) {
  Start start = together(chains(9, 3, 1));
  start.state.x(1, 3 * 4 + 2) = std::nan("");
  on_every_machine([&] {
    Batched<Baumgarte> method(start.system, {}, 0.01);
    State s = start.state;
    const SolveStats stats = method.add_forces(start.system, Push::between_steps(0.01), s);
    EXPECT_FALSE(stats.max_residual < 1);
    EXPECT_EQ(stats.worst_bond / 2, 4);
  });
}

TEST(BondClusters, MoleculesNumberedAlikeFormOneBatch) {
  const BondClusters found =
      find_clusters(together({tests::waters(5, 1, 300), tests::waters(2, 2, 300)}).system);
  ASSERT_EQ(found.batches.size(), 1u);
  EXPECT_EQ(found.batches[0].count, 7);
  EXPECT_EQ(found.batches[0].shape.bond_count(), 3);
  EXPECT_TRUE(found.rest.empty());
  EXPECT_EQ(find_clusters(tests::free_chain(11, 1).system, {.most_bonds = 9}).rest.size(), 10u);
}

// A hundred groups of dumbbells, each of which takes 7/3 of the time of one of waters, and a hundred of waters.
TEST(LaneRunner, SharesOutTimeRatherThanBonds) {
  LaneRunner runner;
  for (const Start& start : {together(chains(800, 2, 3)), tests::waters(800, 1, 300)})
    runner.add(LaneBatch(find_clusters(start.system).batches[0]));
  const ThreadScope two(2);
  std::atomic<int> of_first_thread = 0;
  const SolveStats stats = runner.run([&](int batch, int begin, int end, const Scratch&) {
    if (batch == 0 && begin == 0) of_first_thread = end;
    return SolveStats{};
  });
  EXPECT_TRUE(stats.held());
  EXPECT_EQ(of_first_thread, 71) << "by bonds alone it had all dumbbells";
}

TEST(Elimination, ChainsGoFromBothEndsWithoutFill) {
  const BondClusters found = find_clusters(tests::free_chain(8, 1).system);
  const ClusterShape& shape = found.batches[0].shape;
  const Elimination plan(Couplings(shape.bonds, shape.inv_mass));
  EXPECT_EQ(plan.order, (std::vector<int>{0, 6, 1, 5, 2, 4, 3}));
  EXPECT_EQ(plan.entries(), 6);
  EXPECT_TRUE(plan.update.empty());
}

}  // namespace
}  // namespace taut::batched_tests
