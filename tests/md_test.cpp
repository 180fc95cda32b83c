#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "base/random.hpp"
#include "base/threads.hpp"
#include "error_message.hpp"
#include "md/diagnosis.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "md/velocity_verlet.hpp"

namespace taut::md_tests {
namespace {

System particle(double mass = 1) {
  return make_system(Eigen::VectorXd::Constant(1, mass), {});
}

State at_rest(int atoms) {
  State s;
  s.x = s.v = s.f = Vectors::Zero(3, atoms);
  return s;
}

struct Spring : ForceLaw {  // of constant 1, to the origin
  void evaluate(const System&, State& s) override { s.f = -s.x; }
};

double oscillator_error(double h) {
  const System sys = particle();
  State s = at_rest(1);
  s.x(0, 0) = 1;
  Spring forces;
  ConstraintMethod free;
  forces.evaluate(sys, s);
  while (s.t < 1 - h / 2) EXPECT_TRUE(step({sys, forces, free}, h, s).converged());
  return std::hypot(s.x(0, 0) - std::cos(s.t), s.v(0, 0) + std::sin(s.t));
}

TEST(Step, IsOfSecondOrder) {
  EXPECT_NEAR(oscillator_error(0.01) / oscillator_error(0.005), 4, 0.02);
}

TEST(Step, IsReversible) {
  const System sys = particle();
  State s = at_rest(1);
  s.x.col(0) << 1, 0.5, -0.3;
  const Vectors start = s.x;
  Spring forces;
  ConstraintMethod free;
  forces.evaluate(sys, s);
  for (int n = 0; n < 900; ++n) EXPECT_TRUE(step({sys, forces, free}, 0.05, s).converged());
  EXPECT_GT((s.x - start).norm(), 0.5);
  s.v = -s.v;
  for (int n = 0; n < 900; ++n) EXPECT_TRUE(step({sys, forces, free}, 0.05, s).converged());
  EXPECT_LT((s.x - start).norm(), 1e-12);
}

TEST(Step, AnAnchorDoesNotMove) {
  const System sys = particle(0);
  State s = at_rest(1);
  s.x(0, 0) = 1;
  Spring forces;
  ConstraintMethod free;
  forces.evaluate(sys, s);
  for (int n = 0; n < 10; ++n) EXPECT_TRUE(step({sys, forces, free}, 0.1, s).converged());
  EXPECT_EQ(s.x(0, 0), 1);
}

// Each stage fails in turn.
struct Failing : ConstraintMethod {
  explicit Failing(int its_stage) : stage(its_stage) {}
  int stage;
  SolveStats at(int which) const {
    return {.iterations = 1 << which, .failure = which == stage ? Failure::kNoConvergence : Failure::kNone};
  }
  SolveStats project_positions(const System&, double, State&) override { return at(0); }
  SolveStats add_forces(const System&, const Push&, State&) override { return at(1); }
  SolveStats project_velocities(const System&, double, State&) override { return at(2); }
};
// Counts the ends of steps.
struct Ends : Bath {
  int count = 0;
  double after_step(const System&, double, State&) override { return ++count; }
};

// What any stage did, and that it failed, is said of the step, whose end is then left out.
TEST(Step, SumsWhatItsStagesDid) {
  const System sys = particle();
  Spring forces;
  for (int stage = 0; stage < 4; ++stage) {
    State s = at_rest(1);
    Failing method(stage);
    Ends bath;
    VelocityVerlet verlet;
    const SolveStats stats = verlet.advance({sys, forces, method, bath}, 0.1, s);
    EXPECT_EQ(stats.iterations, 7);
    EXPECT_EQ(stats.converged(), stage == 3) << stage;
    EXPECT_EQ(bath.count, stage == 3) << stage;
    EXPECT_EQ(verlet.account.heat, stage == 3) << "what the bath gives";
  }
}

std::string refusal(Eigen::VectorXd mass, std::vector<RigidBond> bonds) {
  return error_message([&] { make_system(std::move(mass), std::move(bonds)); });
}

TEST(System, RefusesBondsThatMakeNoSense) {
  const Eigen::VectorXd two = Eigen::VectorXd::Ones(2);
  EXPECT_EQ(refusal(two, {{0, 1, 1}}), "no error");
  EXPECT_NE(refusal(two, {{0, 2, 1}}).find("atom 2 is out of range"), std::string::npos);
  EXPECT_NE(refusal(two, {{-1, 1, 1}}).find("atom -1 is out of range"), std::string::npos);
  EXPECT_NE(refusal(two, {{1, 1, 1}}).find("to itself"), std::string::npos);
  EXPECT_NE(refusal(two, {{0, 1, 0}}).find("length 0"), std::string::npos);
  EXPECT_NE(refusal(two, {{0, 1, 1}, {1, 0, 1}}).find("bond 1 (1-0): repeats bond 0"), std::string::npos);
  EXPECT_NE(refusal(Eigen::VectorXd::Zero(2), {{0, 1, 1}}).find("both ends are anchored"), std::string::npos);
  EXPECT_NE(refusal(-two, {}).find("mass -1"), std::string::npos);
}

TEST(SolveStats, IterationsOfStagesAddUpOfPartsSideBySideTheMostCount) {
  SolveStats one{.iterations = 3}, other{.iterations = 3};
  one += {.iterations = 2};
  other.beside({.iterations = 2});
  EXPECT_EQ(one.iterations, 5);
  EXPECT_EQ(other.iterations, 3);
}

TEST(SolveStats, KeepTheWorstResidualAndTheFirstFailureWithTheBondThatIsItsOwn) {
  const double nan = std::nan("");
  const SolveStats none, small{1, 1e-3, 7}, large{1, 0.3, 8}, unknown{1, nan, 9},
      failed{1, 1e-6, 5, Failure::kNoConvergence}, later{1, 0.4, 6, Failure::kSingular};
  const auto bond = [](SolveStats into, const SolveStats& from) {
    SolveStats beside = into;
    beside.beside(from);
    into += from;
    EXPECT_EQ(into.worst_bond, beside.worst_bond);
    EXPECT_EQ(into.failure, beside.failure);
    return into.worst_bond;
  };
  EXPECT_EQ(bond(none, small), 7);
  EXPECT_EQ(bond(small, none), 7);
  EXPECT_EQ(bond(small, large), 8);
  EXPECT_EQ(bond(large, small), 8);
  EXPECT_EQ(bond(large, unknown), 9);  // a NaN is larger than any
  EXPECT_EQ(bond(unknown, large), 9);
  EXPECT_EQ(bond(large, failed), 5);  // a failure, however small its residual
  EXPECT_EQ(bond(failed, large), 5);
  EXPECT_EQ(bond(failed, later), 5);
  SolveStats all = large;
  all += failed;
  EXPECT_EQ(all.max_residual, 1e-6);
  EXPECT_EQ(all.failure, Failure::kNoConvergence);
}

TEST(Box, NearestImageIsTheShortest) {
  const Box box{Vec3(2, 3, 4)};
  EXPECT_LT((box.nearest_image(Vec3(1.9, -1.6, 6.5)) - Vec3(-0.1, 1.4, -1.5)).norm(), 1e-14);
  EXPECT_EQ(Box{}.nearest_image(Vec3(9, 9, 9)), Vec3(9, 9, 9));
}

const Box kSkewed{Vec3(2, 1.8, 1.7), Vec3(-0.9, 0.8, -0.85)};

// Within half the shortest edge of it, of all images.
TEST(Box, NearestImageInASkewedOneIsTheShortest) {
  int near = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 d = 8 * Vec3::Random(), image = kSkewed.nearest_image(d);
    double shortest = HUGE_VAL;
    for (int c = 0; c < 21 * 21 * 21; ++c) {
      const Vec3 other = d + kSkewed.lattice_vector(Vec3(c % 21 - 10, c / 21 % 21 - 10, c / 21 / 21 - 10));
      shortest = std::min(shortest, other.norm());
    }
    if (shortest > 0.85) continue;
    ++near;
    EXPECT_NEAR(image.norm(), shortest, 1e-12);
    const Vec3 steps = kSkewed.fractional(d - image);
    EXPECT_LT((steps - Vec3(steps.array().round())).norm(), 1e-12) << "an image of it";
  }
  EXPECT_GT(near, 500);
}

TEST(Box, FractionalAndReciprocalBelongToItsVectors) {
  const Eigen::Matrix3d m = kSkewed.vectors();
  const Vec3 x(0.3, -0.7, 2.1), g(2, -3, 5);
  EXPECT_LT((m * kSkewed.fractional(x) - x).norm(), 1e-14);
  EXPECT_LT((m.transpose() * kSkewed.reciprocal(g) - g).norm(), 1e-14);
  EXPECT_NEAR(kSkewed.volume(), m.determinant(), 1e-14);
  EXPECT_EQ(Box::of(m), kSkewed);
  const Vec3 by(1.1, 0.9, 1.3);
  EXPECT_LT((kSkewed.scaled(by).vectors() - by.asDiagonal() * m).norm(), 1e-14);
}

TEST(Box, SaysWhatIsWrongWithVectors) {
  const auto flaw = [](int row, int column, double value) {
    Eigen::Matrix3d m = kSkewed.vectors();
    m(row, column) = value;
    return Box::flaw(m);
  };
  EXPECT_EQ(flaw(0, 0, 2), "");
  EXPECT_EQ(flaw(2, 2, 0), "edges of 2 x 1.8 x 0 nm, expected more than 0");
  EXPECT_EQ(flaw(1, 0, 0.1),
            "vectors not in reduced form, expected a = (ax, 0, 0), b = (bx, by, 0), c = (cx, cy, cz)");
  EXPECT_EQ(flaw(0, 1, -1.1), "bx = -1.1 nm, expected at most half of ax = 2 nm: take whole vectors off it");
  EXPECT_EQ(flaw(0, 2, 1.1).substr(0, 11), "cx = 1.1 nm");
  EXPECT_EQ(flaw(1, 2, 0.95),
            "cy = 0.95 nm, expected at most half of by = 1.8 nm: take whole vectors off it");
  EXPECT_EQ(flaw(0, 1, std::nan("")).substr(0, 5), "edges");
}

TEST(DegreesOfFreedom, SpellsItsSum) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}});
  const auto dof = degrees_of_freedom(sys, 1, 3);
  EXPECT_EQ(dof.total(), 5);
  EXPECT_EQ(dof.sum(), "3·3 − 1 − 3 = 5");
  Eigen::VectorXd anchored(2);
  anchored << 0, 1;
  const auto pendulum = degrees_of_freedom(make_system(anchored, {{0, 1, 1}}), 1, 0);
  EXPECT_EQ(pendulum.sum(), "3·1 − 1 = 2");
}

TEST(Observables, MomentumIsRemovedFromWhatCanMove) {
  Eigen::VectorXd mass(3);
  mass << 0, 1, 3;
  const System sys = make_system(mass, {});
  Vectors v = Vectors::Random(3, 3);
  v.col(0).setZero();
  remove_momentum(sys, v);
  EXPECT_LT(momentum(sys, v).norm(), 1e-14);
  EXPECT_EQ(v.col(0), Vec3::Zero());

  const ThreadScope three(3);
  const System large = make_system(Eigen::VectorXd::LinSpaced(1800, 0, 5), {});
  Vectors u = Vectors::Random(3, 1800);
  u.col(0).setZero();
  remove_momentum(large, u);
  EXPECT_LT(momentum(large, u).norm(), 1e-11) << "on three threads";
  EXPECT_EQ(u.col(0), Vec3::Zero());
}

// ½ Σ m v², and 2E = dof·kT.
TEST(Observables, KineticEnergyAndTemperature) {
  const System sys = make_system(Eigen::VectorXd{{2, 3}}, {});
  Vectors v(3, 2);
  v << 1, 0, 2, -1, 2, 4;
  EXPECT_DOUBLE_EQ(kinetic_energy(sys, v), 0.5 * (2 * 9.0 + 3 * 17.0));
  EXPECT_DOUBLE_EQ(temperature(1.5 * kBoltzmann * 300, 3), 300);
  EXPECT_EQ(temperature(1, 0), 0);
}

TEST(Observables, WorstBondErrorIsFound) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}, {1, 2, 2}});
  Vectors x = Vectors::Zero(3, 3);
  x(0, 1) = 1;
  x(0, 2) = 3.2;
  const auto e = bond_errors(sys, x);
  EXPECT_EQ(e.worst, 1);
  EXPECT_NEAR(e.max, 0.1, 1e-14);
  EXPECT_NEAR(e.rms, 0.1 / std::sqrt(2.0), 1e-14);
  x(0, 2) = std::nan("");  // worse than any number
  EXPECT_EQ(bond_errors(sys, x).worst, 1);
  EXPECT_TRUE(std::isnan(bond_errors(sys, x).max));
}

TEST(Diagnosis, SaysWhenAndWhere) {
  const System sys = make_system(Eigen::VectorXd::Ones(4), {{0, 1, 1}, {2, 3, 0.5}});
  State s = at_rest(4);
  s.t = 0.25;
  s.x.col(3) << 0, 3, 4;
  s.f.col(2) << 0, 6, 8;
  s.f.col(1) << 1, 0, 0;
  const Diagnosis d = diagnose(sys, s, {.worst_bond = 1, .failure = Failure::kNoConvergence}, 7);
  EXPECT_EQ(d.step, 7);
  EXPECT_EQ(d.t, 0.25);
  EXPECT_EQ(d.bond, 1);
  EXPECT_EQ(d.held.length, 0.5);
  EXPECT_EQ(d.length, 5);
  EXPECT_EQ(d.largest_force, 10);
  EXPECT_EQ(d.atom, 2);
  EXPECT_EQ(d.cause, "no convergence");
}

// A bond is broken where |σ|/d² reaches ½; a residual that is no number is no bond.
TEST(SolveStats, HoldWhereAllConvergedAndNoBondBroke) {
  EXPECT_TRUE((SolveStats{1, 0.49, 0}.held()));
  EXPECT_FALSE((SolveStats{1, 0.5, 0}.held()));
  EXPECT_FALSE((SolveStats{1, std::nan(""), 0}.held()));
  EXPECT_FALSE((SolveStats{1, 0, 0, Failure::kNoConvergence}.held()));
}

TEST(NearestName, SuggestsTheFewestEdits) {
  EXPECT_EQ(nearest_name("temprature", {"tension", "temperature", "steps"}), "temperature");
  EXPECT_EQ(nearest_name("ratle", {"rattle", "shake"}), "rattle");
  EXPECT_EQ(nearest_name("dt_sf", {"dt_ps", "dt_fs"}), "dt_fs");  // a swap is one
}

TEST(NearestName, SuggestsNothingFarOff) {
  EXPECT_EQ(nearest_name("abcXYf", {"abcdef"}), "abcdef");
  EXPECT_EQ(nearest_name("abXYZf", {"abcdef"}), "");  // 3 of 6
  EXPECT_EQ(nearest_name("ax", {"ab"}), "ab");        // 1 of 2
  EXPECT_EQ(nearest_name("xy", {"ab"}), "");
  EXPECT_EQ(nearest_name("passes", {"name"}), "");
  EXPECT_EQ(nearest_name("temp", {"steps", "temperature_k"}), "temperature_k");  // goes on from it
  EXPECT_EQ(nearest_name("", {"ab"}), "");
  EXPECT_EQ(nearest_name("ab", {}), "");
}

TEST(NearestName, WhereNoneIsNearAllAreNamed) {
  EXPECT_EQ(did_you_mean("shak", {"rattle", "shake"}), "; did you mean \"shake\"?");
  EXPECT_EQ(did_you_mean("lincs", {"rattle", "shake"}), "; expected one of rattle, shake");
  EXPECT_EQ(did_you_mean("lincs", {}), "");
}

}  // namespace
}  // namespace taut::md_tests
