// What each method does for itself: to which error, in how many iterations, and what it says when it cannot.

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/batch/batched_lincs.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "constraints/batch/batched_sweeps.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/mshake.hpp"
#include "constraints/methods/penalty.hpp"
#include "constraints/methods/settle.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "md/diagnosis.hpp"
#include "verifier.hpp"

namespace taut::solvers_tests {
namespace {

using tests::NoForce;
using tests::Start;
using tests::tight;
using tests::verify;

// With the exact matrix an iteration squares what is left; with that of the old bonds it gains a factor.
TEST(MShake, SquaresWhatIsLeftWhereNewtonGainsAFactor) {
  const Start start = tests::free_chain(20, 1);
  const auto left = [&]<class M>(std::type_identity<M>, int iterations) {
    typename M::Options options;
    options.tolerance = 1e-15;
    options.max_iterations = iterations;
    M method(start.system, options, 0.1);
    State s = start.state;
    s.x += 0.1 * s.v;
    return method.project_positions(start.system, 0.1, s).max_residual;
  };
  double before = left(std::type_identity<MShake>{}, 1), newtons = left(std::type_identity<Newton>{}, 1);
  for (int n = 2; before > 1e-8; ++n) {
    const double now = left(std::type_identity<MShake>{}, n);
    EXPECT_LT(now, 30 * before * before + 1e-15) << n;
    before = now;
    const double slowly = left(std::type_identity<Newton>{}, n);
    EXPECT_GT(slowly, 1e-3 * newtons);
    newtons = slowly;
  }
}

TEST(Newton, ReachesRoundOffOnAChainOfTenThousandBonds) {
  NoForce forces;
  Start start = tests::free_chain(10001, 2);
  start.state.x.colwise() -= start.state.x.rowwise().mean();
  const auto verdict =
      verify(start.system, forces, Newton::Options{.tolerance = 1e-13}, 0.01, 5, start.state);
  ASSERT_TRUE(verdict.stats.converged()) << in_words(verdict.stats.failure);
  EXPECT_LT(verdict.bond_error, 1.01e-13);
}

// No more solves than allowed, and what is left is said.
TEST(Newton, StopsAtItsMostIterations) {
  const Start start = tests::free_chain(20, 1);
  NoForce forces;
  const auto stops = [&](auto method) {
    State s = start.state;
    initialize({start.system, forces, method}, 0.01, s);
    const SolveStats stats = method.project_positions(start.system, 0.01, s);
    EXPECT_TRUE(stats.converged());  // nothing has moved
    s.x += 0.05 * s.v;
    const SolveStats moved = method.project_positions(start.system, 0.05, s);
    EXPECT_EQ(moved.failure, Failure::kNoConvergence);
    EXPECT_EQ(moved.iterations, 2);
    EXPECT_GT(moved.max_residual, 1e-14);
  };
  const Newton::Options options{.tolerance = 1e-14, .max_iterations = 2};
  stops(Newton(start.system, options, 0.01));
  stops(Batched<Newton>(start.system, options, 0.01));
}

// The last multipliers foretell the next: that of a rotor, which is constant, is exact.
TEST(WarmStart, OfARotorLeavesNothingToDo) {
  const Start start = tests::rotor(3);
  NoForce forces;
  const auto begins_with = [&](auto method) {
    State s = start.state;
    initialize({start.system, forces, method}, 0.01, s);
    for (int n = 0; n < 5; ++n) EXPECT_TRUE(step({start.system, forces, method}, 0.01, s).converged());
    s.x += 0.01 * s.v;
    return method.project_positions(start.system, 0.01, s).iterations;
  };
  EXPECT_EQ(begins_with(Newton(start.system, {}, 0.01)), 0);
  EXPECT_EQ(begins_with(Batched<Newton>(start.system, {}, 0.01)), 0);
  EXPECT_EQ(begins_with(Rattle(start.system, {}, 0.01)), 1);  // the sweep that finds all well
  EXPECT_EQ(begins_with(Batched<Rattle>(start.system, {}, 0.01)), 1);
}

// What sweeps report is what they left, at most the tolerance, relative to d²: with bonds a tenth and ten
// long.
TEST(Sweeps, MeetTheirToleranceAtEveryLength) {
  for (const double scale : {0.1, 10.0}) {
    Start start = tests::free_chain(12, 3);
    start.state.x *= scale;
    start.state.v *= scale;
    auto bonds = start.system.bonds;
    for (auto& bond : bonds) bond.length = scale;
    start.system = make_system(start.system.mass, bonds);
    NoForce forces;
    const auto meets = [&](auto method, double tolerance) {
      State s = start.state;
      initialize({start.system, forces, method}, 0.01, s);
      for (int n = 0; n < 20; ++n) {
        const SolveStats stats = step({start.system, forces, method}, 0.01, s);
        ASSERT_TRUE(stats.converged());
        EXPECT_LE(stats.max_residual, tolerance);
        EXPECT_LE(bond_errors(start.system, s.x).max, 1.001 * tolerance);
      }
    };
    meets(Rattle(start.system, {{.tolerance = 1e-5}}, 0.01), 1e-5);
    meets(Shake(start.system, {{.tolerance = 1e-5}}, 0.01), 1e-5);
    meets(Newton(start.system, {.tolerance = 1e-5}, 0.01), 1e-5);
  }
}

// |σ|/d² of the worst bond, whatever its length.
TEST(Penalty, ReportsTheRelativeResidual) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 0.1}, {1, 2, 10}});
  State s;
  s.x = s.v = s.f = Vectors::Zero(3, 3);
  s.x(0, 1) = 0.11;
  s.x(0, 2) = 10.2;
  Penalty method(sys, {}, 0.001);
  const SolveStats stats = method.add_forces(sys, Push::between_steps(0.001), s);
  EXPECT_EQ(stats.worst_bond, 0);
  EXPECT_NEAR(stats.max_residual, 0.5 * (1.1 * 1.1 - 1), 1e-12);
}

TEST(Settle, RefusesWhatIsNoWater) {
  const System water = tests::waters(1, 1, 300).system;
  const auto refused = [](const Eigen::VectorXd& mass, const std::vector<RigidBond>& bonds) {
    const System sys = make_system(mass, bonds);
    EXPECT_THROW(Settle(sys, {}, 0.001), InputError);
  };
  EXPECT_NO_THROW(Settle(water, {}, 0.001));
  refused(Eigen::VectorXd{{16, 1, 2}}, water.bonds);  // HDO
  refused(Eigen::VectorXd{{0, 1, 1}}, water.bonds);
  auto bonds = water.bonds;
  bonds[1].length *= 1.001;
  refused(water.mass, bonds);
  bonds = water.bonds;
  bonds[2].length = 2 * bonds[0].length;  // straight
  refused(water.mass, bonds);
  refused(Eigen::VectorXd{{16, 1, 1, 1}}, {{0, 1, 0.1}, {0, 2, 0.1}, {1, 2, 0.15}, {0, 3, 0.1}});
}

TEST(SettleAndNewton, AgreeToRoundOff) {
  NoForce forces;
  const Start start = tests::waters(4, 12, 400);
  const auto settle = verify(start.system, forces, Settle::Options{}, 0.002, 200, start.state);
  const auto newton = verify(start.system, forces, tight<Newton::Options>(), 0.002, 200, start.state);
  ASSERT_TRUE(settle.stats.converged() && newton.stats.converged());
  EXPECT_LT(settle.bond_error, 1e-13);
  EXPECT_LT((settle.end.x - newton.end.x).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((settle.end.v - newton.end.v).cwiseAbs().maxCoeff(), 1e-9);
}

// What the expansion leaves shrinks by C's largest eigenvalue a power, and the turning's error is squared a
// correction.
TEST(Lincs, ConvergesWithOrderAndIterations) {
  NoForce forces;
  const Start start = tests::free_chain(20, 3);
  const auto error = [&](int order, int iterations) {
    const MethodOptions options = Lincs::Options{.order = order, .iterations = iterations};
    return verify(start.system, forces, options, 0.005, 20, start.state).bond_error;
  };
  for (int order = 2; order <= 8; order += 2)
    EXPECT_LT(error(order + 2, 3), 0.7 * error(order, 3)) << "order " << order;
  EXPECT_LT(error(60, 1), 1e-2 * error(60, 0));
  EXPECT_LT(error(60, 2), 1e-2 * error(60, 1));
  EXPECT_LT(error(80, 4), 1e-12);
}

// A triangle with a tail of two: the expansion by dense matrices, bonds in the triangle with as many powers
// again of the couplings T inside it.
TEST(Lincs, BondsInTrianglesGoOnAmongThemselves) {
  Start start = tests::free_chain(5, 3);
  start.state.x << 0, 1, 0.5, 0.5, 1.2,  //
      0, 0, 0.866, 1.866, 2.5,           //
      0, 0, 0, 0.1, 0.4;
  Eigen::VectorXd mass(5);
  mass << 16, 1, 1, 3, 2;
  start.system = make_system(mass, {{0, 1, 1}, {0, 2, 1}, {1, 2, 1}, {2, 3, 1}, {3, 4, 1}});
  const System& sys = start.system;
  const double h = 0.005;
  const int order = 3, m = sys.bond_count();
  Projector(sys).positions(sys, start.state.x);

  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(3 * sys.atoms(), m), weights(3 * sys.atoms(), 1);
  Eigen::VectorXd S(m), length(m);
  for (int k = 0; k < m; ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const Vec3 direction = (start.state.x.col(j) - start.state.x.col(i)).normalized();
    B.block<3, 1>(3 * i, k) = -direction;
    B.block<3, 1>(3 * j, k) = direction;
    S[k] = 1 / std::sqrt(sys.inv_mass[i] + sys.inv_mass[j]);
    length[k] = d;
  }
  for (int a = 0; a < sys.atoms(); ++a) weights.block<3, 1>(3 * a, 0).setConstant(sys.inv_mass[a]);
  const Eigen::MatrixXd inv_mass = weights.col(0).asDiagonal(), scale = S.asDiagonal();
  const Eigen::MatrixXd C = Eigen::MatrixXd::Identity(m, m) - scale * B.transpose() * inv_mass * B * scale;
  Eigen::MatrixXd T = C;
  T.bottomRows(2).setZero();
  T.rightCols(2).setZero();

  State s = start.state;
  s.x += h * s.v;
  const Eigen::VectorXd x = Eigen::Map<Eigen::VectorXd>(s.x.data(), 3 * sys.atoms());
  Eigen::VectorXd power = scale * (B.transpose() * x - length), sum = power;
  for (int n = 0; n < order; ++n) sum += power = C * power;
  for (int n = 0; n < order; ++n) sum += power = T * power;
  const Eigen::VectorXd wanted = x - inv_mass * B * scale * sum;

  State t = s;
  EXPECT_TRUE(Lincs(sys, {.order = order, .iterations = 0}, h).project_positions(sys, h, s).converged());
  EXPECT_TRUE(
      Batched<Lincs>(sys, {.order = order, .iterations = 0}, h).project_positions(sys, h, t).converged());
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(s.x.data(), x.size()) - wanted).norm(), 1e-14);
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(t.x.data(), x.size()) - wanted).norm(), 1e-14);
}

// SHAKE leaves the velocity along the bonds to the next step's correction: the same positions.
TEST(ShakeAndRattle, GiveTheSamePositions) {
  NoForce forces;
  const Start start = tests::free_chain(10, 6);
  const auto shake = verify(start.system, forces, tight<Shake::Options>(), 0.01, 50, start.state);
  const auto rattle = verify(start.system, forces, tight<Rattle::Options>(), 0.01, 50, start.state);
  EXPECT_LT((shake.end.x - rattle.end.x).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_GT((shake.end.v - rattle.end.v).cwiseAbs().maxCoeff(), 1e-6);
}

// A rotor that turns by 3 rad a step: no force along the old bond holds it. The plain methods say so, too.
TEST(Methods, NameTheBondThatTurnedTooFar) {
  const Start start = tests::rotor(300);
  const auto expect = [&](const MethodOptions& options, Failure failure) {
    for (const auto make : {make_method, make_plain}) {
      NoForce forces;
      const auto method = make(start.system, options, 0.01);
      State s = start.state;
      initialize({start.system, forces, *method}, 0.01, s);
      const SolveStats stats = step({start.system, forces, *method}, 0.01, s);
      EXPECT_EQ(stats.failure, failure);
      EXPECT_EQ(stats.worst_bond, 0);
    }
  };
  expect(Shake::Options{}, Failure::kTurned);
  expect(Rattle::Options{}, Failure::kTurned);
  expect(MShake::Options{}, Failure::kSingularOrTurned);
}

// Who takes so many sweeps, whatever they leave, answers for no error.
TEST(Sweeps, OfAFixedNumberPromiseNothing) {
  const System sys = tests::rotor(1).system;
  for (const auto make : {make_method, make_plain}) {
    EXPECT_EQ(make(sys, Shake::Options{{.tolerance = 1e-6}}, 0.01)->promised_error(), 1e-6);
    EXPECT_EQ(make(sys, Rattle::Options{{.tolerance = 1e-6}}, 0.01)->promised_error(), 1e-6);
    EXPECT_TRUE(std::isinf(make(sys, Shake::Options{{.sweeps = 3}}, 0.01)->promised_error()));
    EXPECT_TRUE(std::isinf(make(sys, Rattle::Options{{.sweeps = 3}}, 0.01)->promised_error()));
  }
}

// As many sweeps as asked for, in each half of the step; none more than allowed.
TEST(Sweeps, AreCounted) {
  NoForce forces;
  const Start start = tests::free_chain(6, 4);
  const auto stats = [&](const MethodOptions& options) {
    return verify(start.system, forces, options, 0.01, 1, start.state).stats;
  };
  EXPECT_EQ(stats(Shake::Options{{.sweeps = 3}}).iterations, 3);
  EXPECT_EQ(stats(Rattle::Options{{.sweeps = 3}}).iterations, 6);
  EXPECT_EQ(stats(Shake::Options{{.max_sweeps = 2}}).iterations, 2);
  EXPECT_EQ(stats(Shake::Options{{.max_sweeps = 2}}).failure, Failure::kNoConvergence);
}

}  // namespace
}  // namespace taut::solvers_tests
