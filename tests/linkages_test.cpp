// Linkages of rigid bars, through their dead points: placements in which all bars lie in a line, so that one bond
// follows from the others to first order. conformance has their motions.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/mshake.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "constraints/redundancy.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"

namespace taut::linkages_tests {
namespace {

using tests::NoForce;
using tests::Start;
using tests::UniformForce;

constexpr double kG = 9.81;  // [nm/ps²]

// Two cranks of 1 nm on anchors 1 nm apart, and a bar between their ends: both turn by one angle.
Start parallelogram(const Vec3& crank, const Vec3& v) {
  Start start;
  start.system = make_system(Eigen::Vector4d(0, 0, 1, 1), {{0, 2, 1.0}, {1, 3, 1.0}, {2, 3, 1.0}});
  State& s = start.state;
  s.x = s.v = s.f = Vectors::Zero(3, 4);
  s.x(0, 1) = 1;
  for (const int end : {2, 3}) {
    s.x.col(end) = s.x.col(end - 2) + crank;
    s.v.col(end) = v;
  }
  return start;
}

double angle(const State& s, int crank) {
  const Vec3 along = s.x.col(crank + 2) - s.x.col(crank);
  return std::atan2(along.y(), along.x());
}

struct Named {
  const char* name;
  MethodOptions options;
};
void PrintTo(const Named& named, std::ostream* out) {
  *out << named.name;
}
class Linkage : public ::testing::TestWithParam<Named> {};
INSTANTIATE_TEST_SUITE_P(By, Linkage,
                         ::testing::Values(Named{"newton", default_options("newton")},
                                           Named{"mshake", default_options("mshake")},
                                           Named{"feedforward", default_options("feedforward")},
                                           Named{"unextrapolated", Feedforward::Options{.extrapolation = 0}},
                                           Named{"rattle", default_options("rattle")}),
                         [](const auto& test) { return test.param.name; });

// Whatever place before and beyond the line a step leads from and to.
TEST_P(Linkage, PassesItsDeadPointFromWhereverItComes) {
  UniformForce gravity(Vec3(0, -kG, 0));
  const double h = 5e-3;
  for (int turn = 0; turn < 40; ++turn) {
    Start start = parallelogram({0, 1, 0}, {0.8 + 0.01 * turn, 0, 0});
    State& s = start.state;
    const auto method = make_method(start.system, GetParam().options, h);
    const Dynamics dynamics{start.system, gravity, *method};
    initialize(dynamics, h, s);
    for (int n = 0; n < 240; ++n) ASSERT_TRUE(step(dynamics, h, s).converged()) << turn << ' ' << n;
    ASSERT_LT(angle(s, 0), -0.5);
    ASSERT_NEAR(angle(s, 0), angle(s, 1), 1e-6) << turn;
  }
}

// Thrown up so that it falls back to where a step ends in the line itself, to rounding: a pivot is lost there.
TEST_P(Linkage, PassesFromTheVeryLine) {
  const double h = 1e-3;
  UniformForce gravity(Vec3(0, -kG, 0));
  Start rod;
  rod.system = make_system(Eigen::Vector2d(0, 1), {{0, 1, 1.0}});
  rod.state.x = rod.state.v = rod.state.f = Vectors::Zero(3, 2);
  rod.state.x(0, 1) = rod.state.v(1, 1) = 1;
  Newton of_rod(rod.system, {.tolerance = 1e-14}, h);
  const Dynamics back{rod.system, gravity, of_rod};
  initialize(back, h, rod.state);
  for (int n = 0; n < 20; ++n) ASSERT_TRUE(step(back, h, rod.state).converged());

  Start start = parallelogram(rod.state.x.col(1), -rod.state.v.col(1));
  State& s = start.state;
  const auto method = make_method(start.system, GetParam().options, h);
  const Dynamics dynamics{start.system, gravity, *method};
  initialize(dynamics, h, s);
  double nearest = 1;
  for (int n = 0; n < 40; ++n) {
    ASSERT_TRUE(step(dynamics, h, s).converged()) << n;
    nearest = std::min(nearest, std::abs(angle(s, 0)));
  }
  EXPECT_LT(nearest, 1e-7);
  EXPECT_LT(angle(s, 0), -0.02);
  EXPECT_NEAR(angle(s, 0), angle(s, 1), 1e-6);
}

// Free, its corners moving in and out: it folds flat, and on through itself.
TEST(LinkageInLanes, AFreeRhombusFoldsThroughItself) {
  for (const char* name : {"newton", "mshake", "feedforward", "baumgarte"})
    for (int turn = 0; turn < 20; ++turn) {
      Start start;
      start.system =
          make_system(Eigen::Vector4d::Ones(), {{0, 1, 1.0}, {1, 2, 1.0}, {2, 3, 1.0}, {0, 3, 1.0}});
      State& s = start.state;
      s.x = s.v = s.f = Vectors::Zero(3, 4);
      s.x.topRows(2) << 0, 1, 1, 0,  //
          0, 0, 1, 1;
      s.v.topRows(2) << -1, -1, 1, 1,  //
          -1, 1, 1, -1;
      const double h = 4e-3 + 5e-5 * turn, energy = kinetic_energy(start.system, s.v);
      NoForce none;
      const auto method = make_method(start.system, default_options(name), h);
      const Dynamics dynamics{start.system, none, *method};
      initialize(dynamics, h, s);
      for (int n = 0; n < 300; ++n)
        ASSERT_TRUE(step(dynamics, h, s).converged()) << name << ' ' << turn << ' ' << n;
      EXPECT_NEAR(kinetic_energy(start.system, s.v), energy, 1e-4) << name << ' ' << turn;
    }
}

// A straight angle that its ends hold straight cannot be bent by a solve along its bonds, and no bond is passed over in
// silence.
TEST(LinkageFailures, ABondWhoseErrorStaysIsNamed) {
  const System sys = make_system(Eigen::Vector3d::Ones(), {{0, 1, 1.0}, {1, 2, 1.0}, {0, 2, 2.0}});
  State straight;
  straight.x = straight.v = straight.f = Vectors::Zero(3, 3);
  straight.x.row(0) << 0, 1, 2;
  const double h = 1e-2;
  Newton newton(sys, {}, h);
  MShake mshake(sys, {}, h);
  for (ConstraintMethod* method :
       {static_cast<ConstraintMethod*>(&newton), static_cast<ConstraintMethod*>(&mshake)}) {
    State s = straight;
    s.v.row(1) << 1, -2, 1;
    s.x += h * s.v;
    const SolveStats stats = method->project_positions(sys, h, s);
    EXPECT_TRUE(stats.failure == Failure::kSingular || stats.failure == Failure::kSingularOrTurned);
    EXPECT_GE(stats.worst_bond, 0);
  }
  System contradicted = sys;
  contradicted.bonds[2].length = 1.99;
  State s = straight;
  EXPECT_EQ(newton.project_positions(contradicted, h, s).failure, Failure::kSingularOrTurned);
  Baumgarte feedforward(sys, Feedforward::Options{}, h);
  State bent = straight;
  bent.f.row(1) << 1e3, -2e3, 1e3;
  const SolveStats stats = feedforward.add_forces(sys, Push::at_start(h), bent);
  EXPECT_EQ(stats.failure, Failure::kSingularOrTurned);
  EXPECT_GE(stats.worst_bond, 0);
}

// A plate on three parallel cranks, in their plane: six bonds on six coordinates that move all the same.
Start plate_on_three_cranks() {
  Start start;
  Eigen::VectorXd mass(6);
  mass << 0, 0, 0, 1, 2, 3;
  State& s = start.state;
  s.x = s.v = s.f = Vectors::Zero(3, 6);
  s.x.leftCols(3) << 0, 1, 0.4,  //
      0, 0, 0.5,                 //
      0, 0, 0;
  for (const int end : {3, 4, 5}) s.x.col(end) = s.x.col(end - 3) + Vec3(0.6, 0.8, 0);
  std::vector<RigidBond> bonds;
  for (const auto& [i, j] : std::vector<std::pair<int, int>>{{0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {3, 5}})
    bonds.push_back({i, j, (s.x.col(j) - s.x.col(i)).norm()});
  start.system = make_system(mass, bonds);
  return start;
}

// Of another length the third would lock them: they do not move, and are braced in this placement alone.
TEST(LinkageRedundancy, OfACrankThatLocksTheOthersIsNone) {
  Start start = plate_on_three_cranks();
  start.state.x.col(2) += 0.3 * (start.state.x.col(2) - start.state.x.col(5));
  std::vector<RigidBond> bonds = start.system.bonds;
  bonds[2].length *= 1.3;
  start.system = make_system(start.system.mass, bonds);
  const Redundancy found = find_redundancy(start.system, start.state.x);
  EXPECT_TRUE(found.redundant.empty());
  EXPECT_EQ(found.degenerate.size(), 1u);
}

}  // namespace
}  // namespace taut::linkages_tests
