#include "studies/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <sstream>

#include "base/errors.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "scene_text.hpp"
#include "studies/compared_methods.hpp"
#include "studies/study_scene.hpp"
#include "studies/swept_errors.hpp"
#include "studies/trial.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut::calibration_tests {
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

// Baumgarte reduces a stretch a step as RATTLE with K sweeps does, to a hundredth of the first error, also at long steps.
TEST_P(CalibrationOfSweeps, TheLawCopiesRattle) {
  for (const auto& [name, scene] :
       {std::pair{"chain", chain(10)}, {"water", water(1)}, {"water", water(4)}}) {
    const CalibrationPlan plan{.sweeps = GetParam(), .settle = 20, .steps = 12};
    const Calibration c = calibrate(scene, plan);
    const double a_fifth =
        0.2 * c.reduction_reference;  // as many sweeps leave little, hundredths are no bound
    EXPECT_NEAR(c.of_stretch.measured, c.reduction_reference, std::min(0.002, a_fifth)) << name;
    EXPECT_NEAR(*c.method.reduction / c.reduction_reference, 1, 5e-6) << name;  // six digits of it
    EXPECT_NEAR(c.of_stretch.predicted / *c.method.reduction, 1, 1e-9) << name;
    EXPECT_NEAR(c.of_rate.measured, c.reduction_reference, std::min(0.01, a_fifth)) << name;
    EXPECT_NEAR(c.after_rate.measured, c.reduction_reference, std::min(0.01, a_fifth)) << name;
    EXPECT_LT(c.floor_measured, 3e-8) << name;
    EXPECT_EQ(c.floor_predicted, 0) << name;
    EXPECT_EQ(disagreement(plan, c), "") << name;
  }
}

// Laws with a drive let neighbours move a bond's floor, at order θ: they copy it where bonds turn little a step.
TEST_P(CalibrationOfSweeps, EveryDampingCopiesRattleAtSmallSteps) {
  for (const char* damping : {"centred", "implicit", "lagged"})
    for (const auto& [name, scene] : {std::pair{"chain", chain(1)}, {"water", water(0.25)}}) {
      const Calibration c =
          calibrate(scene, {.sweeps = GetParam(), .damping = damping, .settle = 20, .steps = 12});
      EXPECT_NEAR(c.of_stretch.measured / c.reduction_reference, 1, 0.05) << damping << " " << name;
      EXPECT_NEAR(c.floor_measured / c.floor_predicted, 1, 0.2) << damping << " " << name;
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

TEST(Calibration, SaysWhenAnotherMethodIsToBlame) {
  const CalibrationPlan plan{.sweeps = 1, .damping = "implicit"};
  EXPECT_THAT(disagreement(plan, calibrate(water(4), plan)),
              AllOf(HasSubstr("disagree"), HasSubstr("take --damping discrete")));
}

// What is printed, read again, is what was measured: every option, to the last bit.
TEST(Calibration, ItsSettingsAreTheMethodItMeasured) {
  for (const CalibrationPlan& plan : {CalibrationPlan{.sweeps = 3, .settle = 5, .steps = 5},
                                      {.damping = "lagged", .settle = 5, .steps = 5}}) {
    Scene scene = water(1);
    const Calibration c = calibrate(scene, plan);
    apply_overrides(scene, overrides_of_method(method_of(c)));
    const auto& read = *scene.method.get_if<Baumgarte::Options>();
    EXPECT_EQ(read.gains, c.method.gains);
    EXPECT_EQ(read.damping, plan.damping);
    EXPECT_EQ(read.reduction, c.method.reduction);
    EXPECT_EQ(read.sweeps, c.method.sweeps);
    const Gains gains = choose_gains(read.choice(), damping_named(read.damping), scene.system, 0.001)[0];
    EXPECT_EQ(gains.alpha, c.alpha_per_ps);
    EXPECT_EQ(gains.beta, c.beta_per_ps);
  }
}

// 1 − A(D + L)⁻¹ of a water, as a matrix: A = J M⁻¹Jᵀ.
Eigen::Matrix3d sweep_of_a_water(const Scene& scene) {
  const System& sys = scene.system;
  Eigen::Matrix3d a, lower = Eigen::Matrix3d::Zero();
  const auto across = [&](int k) -> Vec3 {
    return scene.start.x.col(sys.bonds[k].j) - scene.start.x.col(sys.bonds[k].i);
  };
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      const auto &p = sys.bonds[k], &q = sys.bonds[l];
      const auto share = [&](int atom, int of) { return atom == of ? sys.inv_mass[atom] : 0.0; };
      const double weight = share(p.i, q.i) + share(p.j, q.j) - share(p.i, q.j) - share(p.j, q.i);
      a(k, l) = weight * across(k).dot(across(l));
      if (l <= k) lower(k, l) = a(k, l);
    }
  return Eigen::Matrix3d::Identity() - a * lower.inverse();
}

TEST(SweptErrors, OfAWaterAreThoseOfItsMatrix) {
  const Scene scene = water(1);
  const Eigen::Matrix3d sweep = sweep_of_a_water(scene);
  const double largest = sweep.eigenvalues().cwiseAbs().maxCoeff();
  EXPECT_NEAR(largest, 0.6, 0.01);
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(scene.system.bond_count());
  sigma.head<3>() << 1, -2, 0.5;
  for (const int sweeps : {1, 3}) {
    const SweptErrors swept(scene.system, scene.start.x, sweeps);
    Eigen::Vector3d expected = sigma.head<3>();
    for (int n = 0; n < sweeps; ++n) expected = sweep * expected;
    EXPECT_LT((swept.swept(sigma).head<3>() - expected).norm(), 1e-13);
    EXPECT_NEAR(swept.slowest(), std::pow(largest, sweeps), 2e-3);  // waters alike, to their digits
  }
}

// Step by step, wherever bonds meet; what is left of it is the bonds' turn in a step.
TEST(Calibration, CappedRattleFollowsItsSweeps) {
  for (const char* name : {"water", "freely_jointed", "double_pendulum"})
    for (const int sweeps : {1, 2, 4}) {
      const Scene scene = read_scene(find_scene(name), {"run.dt_fs=0.5"});
      const Calibration c = calibrate(scene, {.sweeps = sweeps, .steps = 8});
      ASSERT_EQ(c.shapes.size(), 1u) << name;
      for (int n = 1; n <= 6; ++n)
        EXPECT_NEAR(c.shapes[0].measured[n], c.shapes[0].foretold[n], 0.02 * c.shapes[0].measured[0])
            << name << " " << sweeps << " step " << n;
    }
}

TEST(Calibration, ShapesOfClustersAreToldApart) {
  const Calibration c =
      calibrate(read_scene(find_scene("decane"), {"run.dt_fs=1"}), {.sweeps = 2, .settle = 5, .steps = 6});
  ASSERT_EQ(c.shapes.size(), 1u);
  EXPECT_TRUE(c.shapes[0].name.ends_with("clusters of 9 bonds")) << c.shapes[0].name;
}

// What gains copy: the mean, the first step, or the error that lasts longest, whose course Baumgarte takes
// over to the last step of it, one step later.
TEST(Calibration, CopiesWhatIsAsked) {
  for (const char* damping : {"centred", "discrete"}) {
    const auto with = [&](const char* copies) {
      return calibrate(water(0.5),
                       {.sweeps = 2, .copies = copies, .damping = damping, .settle = 20, .steps = 12});
    };
    const Calibration mean = with("mean"), first = with("first"), slowest = with("slowest");
    const std::vector<double>& reference = mean.reference.stretch;
    EXPECT_NEAR(*mean.method.reduction, std::pow(reference[mean.window] / reference[0], 1.0 / mean.window),
                1e-5);
    EXPECT_NEAR(*first.method.reduction, reference[1] / reference[0], 1e-5);
    EXPECT_NEAR(*slowest.method.reduction, 0.36, 0.01);
    EXPECT_EQ(slowest.method.gains, "swept");
    for (const Calibration& c : {mean, first, slowest}) {
      EXPECT_NEAR(c.of_stretch.measured / c.of_stretch.predicted, 1, 0.05) << c.method.gains;
      EXPECT_NEAR(c.of_rate.measured / c.of_rate.predicted, 1, 0.05) << c.method.gains;
      EXPECT_NEAR(c.after_rate.measured / c.after_rate.predicted, 1, 0.05) << c.method.gains;
    }
    for (int n = 0; n < 5; ++n)
      EXPECT_NEAR(slowest.baumgarte.stretch[n + 1], reference[n], 0.03 * reference[0]) << damping << n;
  }
}

TEST(Calibration, RefusesWhatItCannotDo) {
  EXPECT_THROW(calibrate(chain(10), {.against = "lincs"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.against = "newton", .sweeps = 3}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.damping = "implict"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.copies = "slowest"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.against = "shake", .sweeps = 2, .copies = "slowest"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.sweeps = 2, .copies = "last"}), InputError);
  EXPECT_THROW(calibrate(chain(10), {.against = "rattle:sweeps=2", .sweeps = 3}), InputError);
}

// The table at the end: RATTLE of four sweeps heats water by 10 kJ/mol/ns, what copies its decay does not, and is cheaper.
// The command that it leads to is not doubted.
TEST(Calibration, ComparesMethodsAndSaysWhichToTake) {
  const CalibrationPlan plan{.against = "rattle:sweeps=4", .compared_steps = 1600};
  const Scene scene = water(2);
  const Calibration c = calibrate(scene, plan);
  EXPECT_EQ(c.sweeps, 4);
  EXPECT_EQ(c.method.reduction, calibrate(scene, {.sweeps = 4}).method.reduction);
  const std::vector<ComparedMethod> compared = compare_methods(scene, plan, c);
  ASSERT_EQ(compared.size(), 4u);
  const ComparedMethod &rattle = compared[0], &copy = compared[1];
  EXPECT_EQ(rattle.method, "rattle:sweeps=4");
  EXPECT_EQ(copy.method, method_of(c));
  EXPECT_EQ(compared[3].method, "newton");
  EXPECT_GT(rattle.trial.drift, 5);
  EXPECT_GT(rattle.trial.constraint_drift.value, 5);
  EXPECT_FALSE(rattle.sound());
  EXPECT_TRUE(copy.sound());
  EXPECT_LT(copy.trial.rms_error.value, 1e-2 * rattle.trial.rms_error.value);
  EXPECT_NEAR(copy.reduction.measured / rattle.reduction.measured, 1, 0.02);
  EXPECT_NEAR(compared[2].reduction.measured / compared[2].reduction.predicted, 1, 0.02);
  ASSERT_NE(best_of(compared), nullptr);
  EXPECT_NE(best_of(compared), &rattle);
  EXPECT_THAT(best_of(compared)->doubts, testing::IsEmpty());
  EXPECT_THAT(verdict_of(compared, 2),
              AllOf(testing::StartsWith("take "), HasSubstr("±"), HasSubstr("heats")));
  std::istringstream csv(compared_csv(compared));
  std::string line;
  int lines = 0;
  while (std::getline(csv, line)) ++lines;
  EXPECT_EQ(lines, 5);
}

// Of sound methods that cost alike the calibrated one; without a sound one a shorter step.
TEST(Calibration, TakesTheCheapestSoundMethod) {
  std::vector<ComparedMethod> compared(3);
  compared[0].method = "rattle:sweeps=4", compared[1].method = "baumgarte:gains=rattle",
  compared[2].method = "newton";
  compared[1].role = "as calibrated";
  compared[0].ns_per_bond = {20, 21, 22}, compared[1].ns_per_bond = {8, 9, 10},
  compared[2].ns_per_bond = {7, 8, 8.5};
  for (ComparedMethod& each : compared) each.trial.kT = 2.5;
  EXPECT_EQ(best_of(compared), &compared[1]);
  compared[1].ns_per_bond = {9, 9.5, 10};
  EXPECT_EQ(best_of(compared), &compared[2]);
  compared[2].doubts = {"the constraints heat"};
  EXPECT_EQ(best_of(compared), &compared[1]);
  compared[1].trial.constraint_drift = {3, 0.1};
  EXPECT_EQ(best_of(compared), &compared[0]);
  compared[0].trial.drift = -9;
  EXPECT_EQ(best_of(compared), nullptr);
  EXPECT_THAT(verdict_of(compared, 2), testing::StartsWith("take a shorter step"));
}

// A start that warms up is no method's fault.
TEST(Calibration, TellsDoubtsOfTheSceneFromThoseOfAMethod) {
  std::vector<ComparedMethod> compared(2);
  compared[0].method = "rattle:sweeps=4", compared[1].method = "newton";
  compared[0].doubts = {"without a thermostat the temperature went from 300 to 779 K",
                        "the constraints heat by 9 kJ/mol"};
  compared[1].doubts = {"without a thermostat the temperature went from 300 to 768 K"};
  EXPECT_THAT(take_out_common_doubts(compared), testing::ElementsAre(HasSubstr("768 K")));
  EXPECT_THAT(compared[0].doubts, testing::ElementsAre(HasSubstr("heat")));
  EXPECT_FALSE(compared[0].sound());
  EXPECT_TRUE(compared[1].sound());
  // newton may be the reference, which stands first
  compared[0].method = "newton", compared[1].method = "baumgarte";
  compared[0].doubts.clear(), compared[1].doubts = {"the constraints heat by 9 kJ/mol"};
  EXPECT_THAT(take_out_common_doubts(compared), testing::IsEmpty());
  EXPECT_FALSE(compared[1].sound());
}

// What moves anchors does work, and an energy that it changes has not blown up: who moves along sees a pendulum at rest.
TEST(Trial, HasTheEnergyButForTheWorkOfWhatMoves) {
  const auto trial_of = [&](const std::string& moving) {
    const Scene scene = read(R"([build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [1, 0, 0, 1]]
bonds = [[0, 1, 1]]
gravity_nm_ps2 = [0, -9.81, 0]
)" + moving + "[run]\ndt_fs = 2\nsteps = 2000\n");
    return try_setting(scene, setting_of("newton"), {.steps = 2000});
  };
  const Trial resting = trial_of("");
  const Trial moving =
      trial_of("velocities = [[0, 0, 0], [0, 3, 0]]\n[[motion]]\natoms = [0]\nvelocity_nm_ps = [0, 3, 0]\n");
  EXPECT_EQ(resting.failure, "");
  EXPECT_EQ(moving.failure, "");
  EXPECT_EQ(moving.steps, resting.steps);
}

// For as long as a trial takes.
TEST(Trial, EndsWhereAnchorsMoveBeyondTheReachOfTheirBonds) {
  Scene scene = read(kApart.text);
  scene.run.dt_fs = 3;
  EXPECT_EQ(try_setting(scene, setting_of("newton"), {.steps = 100}).failure, "");
  EXPECT_THAT(try_setting(scene, setting_of("newton"), {.steps = 390}).failure,
              HasSubstr("refused: motion.0.atoms: atom 2 is 2.00"));
}

TEST(Calibration, OfAnchorsThatMoveIsRefused) {
  const Scene scene =
      read(R"(build = {kind = "atoms", atoms = [[0, 0, 0, 0], [1, 0, 0, 1]], bonds = [[0, 1, 1]]}
motion = [{atoms = [0], velocity_nm_ps = [0.3, 0.5, 0.1]}]
)");
  const auto refusal = HasSubstr("scene: motion.0 moves anchors, which taut calibrate would let stand");
  EXPECT_THAT(error_message([&] { calibrate(scene, {}); }), refusal);
  EXPECT_THAT(error_message([&] { reduction_of(scene, default_options("newton"), {}); }), refusal);
}

TEST(Trial, WithoutAnErrorOfItsDriftIsNotSeenToKeepTheEnergy) {
  Trial trial;
  trial.kT = 2.5, trial.drift = 0.01;
  EXPECT_FALSE(trial.keeps_energy());
  trial.drift_error = 0.1;
  EXPECT_TRUE(trial.keeps_energy());
}

// A flat hexagon held by its sides and second neighbours: refused before anything is computed, as a run
// refuses it. A tetrahedron with its centre, all ten distances held, goes without the bond that follows from
// the others.
TEST(Calibration, NeedsBondsThatAreIndependent) {
  const auto scene = [](const Vectors& x) {
    Scene s;
    s.name = "braced";
    s.start.x = x;
    s.start.v = s.start.f = Vectors::Zero(3, x.cols());
    std::vector<RigidBond> bonds;
    for (int i = 0; i < x.cols(); ++i)
      for (int j = 0; j < i; ++j)
        if (const double d = (x.col(i) - x.col(j)).norm(); d < 1.8) bonds.push_back({i, j, d});
    s.system = make_system(Eigen::VectorXd::Ones(x.cols()), bonds);
    s.run.redundant = "drop";
    return s;
  };
  Vectors flat(3, 6), tetrahedron(3, 5);
  for (int k = 0; k < 6; ++k) flat.col(k) << std::cos(M_PI * k / 3), std::sin(M_PI * k / 3), 0;
  tetrahedron << 0, 1, 1, -1, -1, 0, 1, -1, 1, -1, 0, 1, -1, -1, 1;
  EXPECT_THAT(error_message([&] { prepared_for_study(scene(flat)); }),
              AllOf(HasSubstr("braced: bonds "), HasSubstr("cannot act in this placement")));
  const Scene held = prepared_for_study(scene(0.5 * tetrahedron));
  EXPECT_EQ(held.system.bond_count(), 9);
  EXPECT_THAT(held.notes, testing::ElementsAre("1 bond is left out that follows from others"));
}

// A floor of 1e-17 is rounding, and a reduction of 3e-7 of an error of 1e-6 is its square.
TEST(Calibration, SaysNothingOfRounding) {
  for (const char* dt_fs : {"0.1", "0.01"}) {
    const Calibration c = calibrate(read_scene(find_scene("pair"), {std::string("run.dt_fs=") + dt_fs}), {});
    EXPECT_LT(c.floor_measured, 1e-14);
    EXPECT_EQ(disagreement({}, c), "");
  }
  Calibration c;
  c.rounding = 1e-15;
  c.floor_predicted = 4e-14, c.floor_measured = 6e-14;
  EXPECT_EQ(disagreement({}, c), "");
  c.floor_measured = 2e-13;
  EXPECT_THAT(disagreement({}, c), HasSubstr("floor 2e-13 for 4e-14"));
}

}  // namespace
}  // namespace taut::calibration_tests
