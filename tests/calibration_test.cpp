#include "studies/calibration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "constraints/baumgarte.hpp"
#include "md/errors.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Scene chain(double dt_fs) {
  return read_scene(find_scene("freely_jointed"), {"build.chains=40", "run.dt_fs=" + std::to_string(dt_fs)});
}
Scene water(double dt_fs) {
  return read_scene(find_scene("water"), {"run.dt_fs=" + std::to_string(dt_fs)});
}

class CalibrationOfSweeps : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Sweeps, CalibrationOfSweeps, ::testing::Values(1, 2, 4, 8));

// Baumgarte reduces a stretch a step as RATTLE with K sweeps does, within 5 %, at the steps people run.
TEST_P(CalibrationOfSweeps, CentredCopiesRattleAtOrdinarySteps) {
  for (const auto& [name, scene] : {std::pair{"chain", chain(10)}, {"water", water(1)}}) {
    const Calibration c = calibrate(scene, {.sweeps = GetParam(), .settle = 20, .steps = 12});
    EXPECT_NEAR(c.reduction_measured / c.reduction_reference, 1, 0.05) << name;
    EXPECT_NEAR(c.method.reduction / c.reduction_reference, 1, 5e-6) << name;  // six digits of it
    EXPECT_NEAR(c.reduction_predicted / c.method.reduction, 1, 1e-9) << name;
    EXPECT_NEAR(c.reduction_of_rate / c.reduction_reference, 1, 0.05) << name;
    EXPECT_NEAR(c.reduction_after_rate / c.reduction_reference, 1, 0.1) << name;
    EXPECT_NEAR(c.floor_measured / c.floor_predicted, 1, 0.05) << name;
  }
}

// The other dampings let neighbours move a bond's floor, at order θ: they copy it where bonds turn little a
// step.
TEST_P(CalibrationOfSweeps, EveryDampingCopiesRattleAtSmallSteps) {
  for (const char* damping : {"implicit", "lagged"})
    for (const auto& [name, scene] : {std::pair{"chain", chain(1)}, {"water", water(0.25)}}) {
      const Calibration c =
          calibrate(scene, {.sweeps = GetParam(), .damping = damping, .settle = 20, .steps = 12});
      EXPECT_NEAR(c.reduction_measured / c.reduction_reference, 1, 0.05) << damping << " " << name;
      EXPECT_NEAR(c.floor_measured / c.floor_predicted, 1, 0.2) << damping << " " << name;
    }
}

TEST(Calibration, MoreSweepsReduceMore) {
  double before = 1;
  for (const int sweeps : {1, 2, 4, 8}) {
    const double r = calibrate(water(1), {.sweeps = sweeps, .settle = 5, .steps = 10}).reduction_reference;
    EXPECT_LT(r, before);
    before = r;
  }
}

// A converged RATTLE leaves nothing: dead-beat gains.
TEST(Calibration, ConvergedRattleIsDeadBeat) {
  for (const char* against : {"rattle", "newton"}) {
    const Calibration c = calibrate(chain(10), {.against = against, .settle = 10, .steps = 6});
    EXPECT_LT(c.reduction_reference, 1e-3);
    EXPECT_NEAR(c.alpha_per_ps * 0.01, 1, 1e-9);
    EXPECT_NEAR(c.beta_per_ps * 0.01, std::sqrt(2), 1e-3);
    EXPECT_LT(c.baumgarte.stretch[2], 0.01 * c.baumgarte.stretch[1]);
  }
}

// Whatever the gains, ¼h²a·u of a stretch stays: θ²/4 = 0.0025 for the rotor that turns by 0.1 a step. A copy
// of a converged RATTLE comes down to that, and says so; a copy of a few sweeps is above it, and has nothing
// to say.
TEST(Calibration, SaysWhatNoGainTakesAway) {
  const Scene rotor = read_scene(find_scene("diatomic"));
  const CalibrationPlan sharp{.settle = 10, .steps = 6};
  EXPECT_NEAR(calibrate(rotor, sharp).left, 0.0025, 2e-5);
  for (const auto& [name, scene] : {std::pair{"rotor", rotor}, {"water", water(2)}}) {
    const Calibration c = calibrate(scene, sharp);
    EXPECT_NEAR(c.reduction_measured / c.left, 1, 0.1) << name;
    EXPECT_THAT(disagreement(sharp, c),
                AllOf(HasSubstr("disagree"), HasSubstr(fmt::format("leaves some {:.1e}", c.left)),
                      HasSubstr("shorter step"), HasSubstr("feedforward")));
  }
  const CalibrationPlan plan{.sweeps = 4};
  EXPECT_EQ(disagreement(plan, calibrate(water(1), plan)), "");
}

TEST(Calibration, SaysWhenAnotherMethodIsToBlame) {
  const auto said = [](const CalibrationPlan& plan) { return disagreement(plan, calibrate(water(1), plan)); };
  EXPECT_THAT(said({.sweeps = 4, .passes = 1}), HasSubstr("take --passes 2"));
  EXPECT_THAT(said({.sweeps = 8, .damping = "implicit"}), HasSubstr("take --damping centred"));
}

// What is printed, read again, is what was measured: every option, to the last bit.
TEST(Calibration, ItsSettingsAreTheMethodItMeasured) {
  for (const CalibrationPlan& plan : {CalibrationPlan{.sweeps = 3, .settle = 5, .steps = 5},
                                      {.damping = "lagged", .passes = 3, .settle = 5, .steps = 5}}) {
    Scene scene = water(1);
    const Calibration c = calibrate(scene, plan);
    apply_overrides(scene, settings_of(c));
    const auto& read = *scene.method.get_if<Baumgarte::Options>();
    EXPECT_EQ(read.gains, c.method.gains);
    EXPECT_EQ(read.damping, plan.damping);
    EXPECT_EQ(read.reduction, c.method.reduction);
    EXPECT_EQ(read.passes, plan.passes);
    EXPECT_EQ(read.sweeps, c.method.sweeps);
    const Gains gains = choose_gains(read.choice(), damping_named(read.damping), scene.system, 0.001)[0];
    EXPECT_EQ(gains.alpha, c.alpha_per_ps);
    EXPECT_EQ(gains.beta, c.beta_per_ps);
  }
}

// RATTLE of K sweeps, T = (I − A(D+L)⁻¹)^K: σ₊ = T(σ + σ̇h), σ̇₊h = T(σ₊ − σ), from random σ/d² on a water's
// bonds.
std::vector<double> course_of_sweeps(int sweeps, int steps) {
  const Scene scene = water(1);
  const System& sys = scene.system;
  Eigen::Matrix3d a, lower = Eigen::Matrix3d::Zero();
  Eigen::Vector3d squares;
  const auto across = [&](int k) -> Vec3 {
    return scene.start.x.col(sys.bonds[k].j) - scene.start.x.col(sys.bonds[k].i);
  };
  for (int k = 0; k < 3; ++k) {
    squares[k] = std::pow(sys.bonds[k].length, 2);
    for (int l = 0; l < 3; ++l) {
      const auto &p = sys.bonds[k], &q = sys.bonds[l];
      const auto share = [&](int atom, int of) { return atom == of ? sys.inv_mass[atom] : 0.0; };
      const double weight = share(p.i, q.i) + share(p.j, q.j) - share(p.i, q.j) - share(p.j, q.i);
      a(k, l) = weight * across(k).dot(across(l));
      if (l <= k) lower(k, l) = a(k, l);
    }
  }
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), sweep = one - a * lower.inverse();
  Eigen::Matrix3d t = one;
  for (int n = 0; n < sweeps; ++n) t *= sweep;
  Eigen::Matrix3d stretch = squares.asDiagonal(), rate = Eigen::Matrix3d::Zero();
  std::vector<double> course;
  for (int n = 0; n <= steps; ++n) {
    course.push_back((squares.cwiseInverse().asDiagonal() * stretch).norm());
    const Eigen::Matrix3d next = t * (stretch + rate);
    rate = t * (next - stretch);
    stretch = next;
  }
  return course;
}

TEST(Calibration, CappedRattleFollowsItsSweeps) {
  for (const int sweeps : {1, 2, 4}) {
    const std::vector<double> measured = calibrate(water(1), {.sweeps = sweeps}).reference.stretch;
    const std::vector<double> foretold = course_of_sweeps(sweeps, 2);
    const auto ratio = [](const std::vector<double>& course, int n) { return course[n + 1] / course[n]; };
    EXPECT_NEAR(ratio(measured, 0) / ratio(foretold, 0), 1, 0.05) << sweeps;
    EXPECT_NEAR(ratio(measured, 1) / ratio(foretold, 1), 1, 0.2) << sweeps;
  }
}

TEST(Calibration, RefusesWhatItCannotDo) {
  EXPECT_THROW(calibrate(chain(10), {.against = "lincs"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.against = "newton", .sweeps = 3}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.damping = "implict"}), InputError);
}

}  // namespace
}  // namespace taut
