// The figures a run ends with: temperatures of what is thermal, an error of the drift that holds over seeds,
// and what they say against the run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "constraints/projection.hpp"
#include "md/units.hpp"
#include "pressure_of.hpp"
#include "run_of_scene.hpp"
#include "simulation/doubts.hpp"
#include "simulation/unresolved_motion.hpp"

namespace taut::run_figures_tests {
namespace {

using tests::Overrides;
using tests::rows_of;
using tests::summary_of;

// Whatever the bath temperatures are of P(v + (h/2)M⁻¹f), as are those by kind of motion and the pressure's part; the
// energy is of v, whose temperature is a column of its own.
TEST(ThermalVelocity, IsThatOfTheDriftUnderEveryBath) {
  for (const char* thermostat : {"run.thermostat=none", "run.thermostat_ps=0.1", "run.thermostat=langevin"}) {
    Simulation simulation(scene_of("water", {thermostat, "run.steps=40", "run.log_every=40", "run.dt_fs=4"}));
    simulation.run({});
    const System& sys = simulation.scene().system;
    const State& s = simulation.state();
    Vectors u = s.v;
    for (int a = 0; a < sys.atoms(); ++a) u.col(a) += 0.5 * 4e-3 * sys.inv_mass[a] * s.f.col(a);
    Projector(sys).velocities(sys, s.x, u);
    const Record r = simulation.full_record();
    const int dof = simulation.dof().total();
    EXPECT_NEAR(r.temperature, temperature(kinetic_energy(sys, u), dof), 1e-6) << thermostat;
    EXPECT_NEAR(r.kinetic, kinetic_energy(sys, s.v), 1e-6);
    EXPECT_NEAR(r.full_step_temperature, temperature(r.kinetic, dof), 1e-9);
    EXPECT_GT(std::abs(r.temperature - r.full_step_temperature), 1);
    ForceField forces(sys, s.box, simulation.scene().terms);
    State drifting = s;
    drifting.v = u;
    EXPECT_NEAR(*r.pressure, tests::pressure_of(sys, forces, drifting).trace() / 3, 0.01);
  }
}

// SHAKE's positions are RATTLE's; its velocities keep a part along the bonds, which is not heat.
TEST(ThermalVelocity, OfShakeIsRattles) {
  for (const char* thermostat : {"run.thermostat=none", "run.thermostat_ps=0.02"}) {
    const auto rows = [&](const char* method) {
      return rows_of("water", {method, thermostat, "run.steps=40", "run.log_every=5"});
    };
    const auto shake = rows("method.name=shake"), rattle = rows("method.name=rattle");
    ASSERT_EQ(shake.size(), rattle.size());
    for (std::size_t n = 0; n < shake.size(); ++n) {
      EXPECT_NEAR(shake[n].temperature / rattle[n].temperature, 1, 1e-5) << thermostat;
      EXPECT_NEAR(shake[n].kinetic / rattle[n].kinetic, 1, 1e-5);
      EXPECT_NEAR(*shake[n].pressure, *rattle[n].pressure, 1);
    }
  }
}

// Springs that start cold take up heat; the thermostat keeps what the bonds leave free at its temperature.
TEST(ThermalVelocity, OfSpringsUnderRescalingIsWhatTheBondsLeaveFree) {
  Simulation simulation(scene_of("water", {"method.name=penalty", "run.dt_fs=0.5", "run.thermostat_ps=0.02",
                                           "run.steps=3000", "run.log_every=20"}));
  simulation.run({});
  for (const MotionClass motion : {MotionClass::kTranslation, MotionClass::kRotation}) {
    const Estimate t = simulation.temperatures().of_all(motion);
    EXPECT_NEAR(t.value, 298.15, 9) << kMotionNames[static_cast<int>(motion)];
  }
}

// Rows are compared with a first one of the same velocity, unless its velocities were drawn: those are of full steps.
TEST(StartAndEnd, BeginsWithTheVelocityThatLaterRowsAreOf) {
  const Overrides overrides = {"run.dt_fs=4", "run.steps=20", "run.log_every=10"};
  const auto expected_and_first = [](const Scene& scene) {
    std::vector<Record> rows;
    const Summary summary = Simulation(scene).run([&](const Record& r) { rows.push_back(r); });
    return std::pair(summary.start_and_end.expected, rows.front());
  };
  Scene scene = scene_of("water", overrides);
  const auto [drawn, first] = expected_and_first(scene);
  EXPECT_EQ(drawn, first.full_step_temperature);
  EXPECT_GT(std::abs(first.temperature / first.full_step_temperature - 1), 1e-3);
  scene.velocities_drawn = false;  // as of a start that goes on
  const auto [given, again] = expected_and_first(scene);
  EXPECT_EQ(given, again.temperature);
}

// Two masses on a spring swing at √(k/μ); an angle whose bonds are rigid at √(k gᵀPM⁻¹g), less than with free ones.
TEST(UnresolvedMotion, IsTheFastestSprings) {
  Scene scene;
  scene.system = make_system(Eigen::Vector3d(1, 4, 2), {});
  scene.terms.bonds = {{0, 1, 0.1, 1000}, {1, 2, 0.1, 1e5}};
  Vectors x(3, 3);
  x << 0.1, 0, -0.03, 0, 0, 0.09, 0, 0, 0.02;
  scene.run.dt_fs = 5;
  const double omega = std::sqrt(1e5 / (4.0 / 3));  // ωh = 1.37
  EXPECT_EQ(unresolved_motion(scene, x), "");
  scene.run.dt_fs = 1.51e3 / omega;
  EXPECT_NE(unresolved_motion(scene, x).find("the bond of atoms 1-2, a spring whose ωh is 1.5 "),
            std::string::npos)
      << unresolved_motion(scene, x);
  const auto angle = [](const Vectors& at) {
    const Vec3 u = at.col(0) - at.col(1), w = at.col(2) - at.col(1);
    return std::acos(u.dot(w) / (u.norm() * w.norm()));
  };
  Vectors M_g(3, 3);
  for (int a = 0; a < 3; ++a)
    for (int d = 0; d < 3; ++d) {
      Vectors there = x, back = x;
      there(d, a) += 1e-6, back(d, a) -= 1e-6;
      M_g(d, a) = (angle(there) - angle(back)) / 2e-6 * scene.system.inv_mass[a];
    }
  scene.terms.bonds.clear();
  scene.terms.angles = {{0, 1, 2, 2, 500}};
  double free = 0;
  for (const bool rigid : {false, true}) {
    if (rigid) {
      scene.system =
          make_system(Eigen::Vector3d(1, 4, 2), {{0, 1, 0.1}, {1, 2, (x.col(2) - x.col(1)).norm()}});
      Projector(scene.system).velocities(scene.system, x, M_g);
    }
    const double frequency = std::sqrt(500 * 2 * kinetic_energy(scene.system, M_g));
    if (rigid) {
      EXPECT_LT(frequency, 0.99 * free);
    }
    free = frequency;
    scene.run.dt_fs = 1.499e3 / frequency;
    EXPECT_EQ(unresolved_motion(scene, x), "");
    scene.run.dt_fs = 1.501e3 / frequency;
    EXPECT_NE(unresolved_motion(scene, x).find("angle of atoms 0-1-2"), std::string::npos);
  }
}

// Where a method holds a bond by a spring nothing holds what lies along it.
TEST(UnresolvedMotion, IsThereAlongBondsThatAreSprings) {
  Scene scene;
  scene.system = make_system(Eigen::Vector2d(1, 1), {{0, 1, 0.1}});
  scene.terms.bonds = {{0, 1, 0.1, 1e7}};
  Vectors x = Vectors::Zero(3, 2);
  x(0, 1) = 0.1;
  EXPECT_EQ(unresolved_motion(scene, x), "");
  EXPECT_NE(unresolved_motion(scene, x, true), "");
}

// It is said before the first step.
TEST(UnresolvedMotion, IsANoteOfTheRun) {
  Scene scene = scene_of("trimer", {"build.beads=2", "build.chains=1"});
  scene.terms.bonds = {{0, 1, 1, 1e9}};
  scene.system.bonds.clear();
  const Simulation simulation(scene);
  bool noted = false;
  for (const std::string& note : simulation.scene().notes)
    noted |= note.find("does not resolve") != note.npos;
  EXPECT_TRUE(noted);
}

// The note is of the step that there is, however that came to be.
TEST(UnresolvedMotion, IsNotedOfAStepThatIsTakenLater) {
  Scene scene = scene_of("trimer", {"build.beads=2", "build.chains=1"});
  scene.terms.bonds = {{0, 1, 1, 1}};
  scene.system.bonds.clear();
  Simulation simulation(scene);
  const auto noted = [&] {
    return std::ranges::count_if(simulation.scene().notes, [](const std::string& note) {
      return note.find("does not resolve") != note.npos;
    });
  };
  const double resolved = scene.run.dt_fs;
  EXPECT_EQ(noted(), 0);
  for (const double times : {1000.0, 2000.0}) {
    simulation.change_step(times * resolved, scene.method);
    EXPECT_EQ(noted(), 1) << times;
  }
  simulation.change_step(resolved, scene.method);
  EXPECT_EQ(noted(), 0);
}

// White noise, noise with a memory, a random walk, and a walk under noise. With a walk what is printed is the
// scatter; without one it is more, for no run is long enough to tell that it has none.
TEST(RunningSlope, ErrorIsTheScatterOverSeeds) {
  struct Kind {
    double noise, memory, walk;
  };
  for (const auto& [noise, memory, walk] :
       {Kind{1, 0, 0}, Kind{1, 0.9, 0}, Kind{0, 0, 0.3}, Kind{1, 0.5, 0.1}}) {
    const int seeds = 200;
    double squares = 0, variances = 0, mean = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random random(seed);
      RunningSlope slope;
      double x = 0, w = 0;
      for (int n = 0; n < 700; ++n) {
        x = memory * x + std::sqrt(1 - memory * memory) * random.normal();
        w += walk * random.normal();
        slope.add(0.1 * n, 3 + 2 * 0.1 * n + noise * x + w);
      }
      const Estimate e = slope.estimate();
      mean += e.value / seeds;
      squares += (e.value - 2) * (e.value - 2) / seeds;
      variances += e.error * e.error / seeds;
    }
    EXPECT_NEAR(mean, 2, 4 * std::sqrt(squares / seeds));
    const double ratio = std::sqrt(variances / squares);
    EXPECT_GT(ratio, 0.75) << noise << ' ' << memory << ' ' << walk;
    EXPECT_LT(ratio, walk > 0 ? 1.3 : 5.0) << noise << ' ' << memory << ' ' << walk;
  }
}

// Numbers that do nothing but alternate: V(2L) = 0, so that there is no walk and c = ⅔LV(L).
TEST(RunningSlope, ErrorOfNoiseAlone) {
  RunningSlope slope;
  for (int n = 0; n < 16; ++n) slope.add(n, n % 2 == 0 ? 1 : -1);
  const double v = 15 * 4 / 14.0;
  EXPECT_NEAR(slope.estimate().error, std::sqrt(12 * (2 * v / 3) / (15 * 15 * 15)), 1e-3);
}

TEST(RunningSlope, SaysNoErrorOfAFewPoints) {
  RunningSlope slope;
  for (int n = 0; n < 7; ++n) slope.add(n, n % 2 + n);
  EXPECT_EQ(slope.estimate().error, 0);
  EXPECT_GT(slope.estimate().value, 0);
}

// The run says itself where a method does not work: lincs cools water, and none lets bonds go.
TEST(Doubts, OfMethodsThatDoNotWork) {
  const Overrides water = {"run.steps=600", "run.log_every=5"};
  const auto with = [&](const char* method) {
    Overrides all = water;
    all.emplace_back(method);
    return summary_of("water", all);
  };
  const Summary lincs = with("method.name=lincs"), newton = with("method.name=newton");
  ASSERT_EQ(lincs.doubts.size(), 1u);
  EXPECT_NE(
      lincs.doubts[0].find("a nanosecond and degree of freedom; feedforward at the same price does not"),
      std::string::npos)
      << lincs.doubts[0];
  EXPECT_EQ(lincs.converged, std::nullopt);
  EXPECT_TRUE(newton.doubts.empty());
  EXPECT_EQ(newton.converged, true);
  EXPECT_TRUE(with("method.name=baumgarte").doubts.empty());
  EXPECT_TRUE(with("method.name=feedforward").doubts.empty());
}

// What rescaled velocities leave of the bonds is over feedforward's tolerance, and no reason to doubt.
TEST(Doubts, NotOfRescaledVelocities) {
  const Summary s = summary_of("water", {"run.dt_fs=1", "run.steps=600", "run.log_every=5",
                                         "run.thermostat_ps=1", "method.name=feedforward"});
  EXPECT_GT(s.max_rel_bond_error, 2e-7);
  EXPECT_TRUE(s.doubts.empty());
}

TEST(Doubts, OfFigures) {
  Summary s;
  s.temperature = 300;
  s.drift = Estimate{5, 0.9};
  s.converged = true;
  ASSERT_EQ(doubts(s).size(), 1u);
  EXPECT_NE(doubts(s)[0].find("2 kT a nanosecond and degree of freedom; take a shorter step, or let"),
            std::string::npos);
  s.drift = Estimate{-5, 1.1};  // chance
  EXPECT_TRUE(doubts(s).empty());
  s.drift = Estimate{2, 0.01};  // little
  EXPECT_TRUE(doubts(s).empty());
  s.drift = Estimate{100, 0};  // too few rows to tell
  EXPECT_TRUE(doubts(s).empty());
  s.converged = false;
  EXPECT_EQ(doubts(s).size(), 1u);
  s.converged.reset();
  s.max_rel_bond_error = 0.04;
  EXPECT_TRUE(doubts(s).empty());
  s.max_rel_bond_error = 0.06;
  EXPECT_EQ(doubts(s).size(), 1u);
}

// Where most of the drift is the bonds', they are blamed, and from a quarter of kT on.
TEST(Doubts, OfConstraintsThatHeat) {
  Summary s;
  s.temperature = 300;
  const auto said = [&](Estimate drift, Estimate of_bonds) {
    s.drift = drift;
    s.constraint_drift = of_bonds;
    const std::vector<std::string> all = doubts(s);
    return all.empty() ? "" : all[0];
  };
  const std::string heat = "the constraints heat by 4.5 kJ/mol a nanosecond and degree of freedom; ";
  EXPECT_EQ(said({5, 0.9}, {4.5, 0.1}),
            heat + "feedforward at the same price does not (where bonds are one-sided: rattle)");
  EXPECT_EQ(said({-1, 0.1}, {-0.9, 0.1}).substr(0, 31), "the constraints cool by 0.9 kJ/");
  EXPECT_EQ(said({1, 0.01}, {0.5, 0.01}), "");  // a fifth of kT
  EXPECT_EQ(said({1, 0.01}, {0.9, 0.3}), "");   // chance
  EXPECT_NE(said({5, 0.1}, {0.9, 0.1}).find("the energy drifts by 2 kT"), std::string::npos);
  s.converged = true;
  EXPECT_EQ(said({5, 0.9}, {4.5, 0.1}), heat + "take a shorter step");
}

// Where a thermostat bears it: from a hundredth of the temperature on.
TEST(Doubts, OfADriftThatAThermostatBears) {
  Summary s;
  s.temperature = 300;
  s.drift = s.constraint_drift = Estimate{40, 1};
  s.off_by_k = 2.9;
  EXPECT_TRUE(doubts(s).empty());
  s.off_by_k = 3.1;
  ASSERT_EQ(doubts(s).size(), 1u);
  EXPECT_NE(doubts(s)[0].find("degree of freedom, which the thermostat leaves 3.1 K too warm; feedforward"),
            std::string::npos);
  s.drift = Estimate{std::nan(""), 0};  // under a barostat
  ASSERT_EQ(doubts(s).size(), 1u);
  EXPECT_NE(doubts(s)[0].find("the constraints heat by 40 kJ/mol"), std::string::npos);
  s.constraint_drift.value = 0;
  s.drift = Estimate{-40, 1};
  s.off_by_k = -3.1;
  EXPECT_NE(doubts(s)[0].find("degree of freedom, which the thermostat leaves 3.1 K too cold; take"),
            std::string::npos);
}

// λ extrapolated to second order runs ahead of bonds that turn far in a step: there the step starts anew from the last λ.
// Beyond, it tells of the extrapolation, without which it holds what shake holds.
TEST(Feedforward, StartsAStepAnewAndTellsOfItsExtrapolation) {
  const auto longest = [](const char* method, const char* setting, const char* step) {
    return Simulation(scene_of("water", {method, setting, step, "run.steps=200"})).run({});
  };
  EXPECT_EQ(longest("method.name=shake", "method.tolerance=1e-8", "run.dt_fs=8").steps, 200);
  for (const auto& [setting, step] :
       {std::pair("method.extrapolation=0", "run.dt_fs=8"), {"method.extrapolation=2", "run.dt_fs=7.5"}}) {
    const Summary held = longest("method.name=feedforward", setting, step);
    EXPECT_EQ(held.steps, 200) << setting;
    EXPECT_LT(held.max_rel_bond_error, 1e-6) << setting;
  }
  Simulation failing(scene_of("water", {"method.name=feedforward", "run.dt_fs=8.5", "run.steps=200"}));
  EXPECT_THROW(failing.run({}), SimulationFailure);
  const auto diagnosis = failing.diagnose();
  ASSERT_TRUE(diagnosis);
  EXPECT_NE(diagnosis->advice.find("method.extrapolation = 0"), std::string::npos) << diagnosis->advice;
}

}  // namespace
}  // namespace taut::run_figures_tests
