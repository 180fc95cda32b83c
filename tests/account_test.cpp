// Whose the drift of a run's energy is: the bonds', the bath's or the forces'.

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "md/units.hpp"
#include "run_of_scene.hpp"

namespace taut::account_tests {
namespace {

using tests::rows_of;
using tests::summary_of;

// Implicit damping, dead-beat, heats water by its bonds alone; newton's do nothing.
TEST(Account, SaysWhoseTheDriftIs) {
  const auto run = [](std::vector<std::string> method) {
    method.insert(method.end(), {"run.steps=1000", "run.log_every=10", "forcefield.switch_nm=0.75"});
    return summary_of("water", method);
  };
  const Summary implicit =
      run({"method.name=baumgarte", "method.damping=implicit", "method.gains=dead-beat"});
  const Summary newton = run({"method.name=newton"});
  EXPECT_GT(implicit.constraint_drift.value, 50);
  EXPECT_NEAR(implicit.constraint_drift.value / implicit.drift.value, 1, 0.1);
  EXPECT_LT(std::abs(newton.constraint_drift.value), 0.03 * implicit.constraint_drift.value);
  EXPECT_LT(std::abs(newton.constraint_work), 0.03 * implicit.constraint_work);
}

// What rescaling gives springs, and velocities that keep a part along the bonds, is counted as it is logged:
// the bonds' share is what it is without, next to nothing.
TEST(Account, OfRescaledVelocitiesIsTheBathsForEveryMethod) {
  for (const char* method : {"newton", "shake", "penalty", "feedforward"}) {
    const std::vector<Record> rows =
        rows_of("freely_jointed",
                {"build.chains=1", std::string("method.name=") + method, "run.dt_fs=2",
                 "run.temperature_k=300", "run.thermostat_ps=0.05", "run.steps=400", "run.log_every=20"});
    double most = 0, bonds = 0;
    for (const Record& r : rows) {
      most = std::max(most, std::abs(*r.heat));
      bonds = std::max(bonds, std::abs(r.constraint_work));
    }
    EXPECT_GT(most, 0.3 * rows.front().kinetic) << method;
    EXPECT_LT(bonds, 0.02 * most) << method;
  }
}

// The thermostat takes what the bonds give, and is as much too warm as that takes.
TEST(Account, SaysHowFarADriftKeepsTheThermostatOff) {
  const Summary s =
      summary_of("water", {"run.dt_fs=2", "run.steps=5000", "run.log_every=20", "run.thermostat_ps=0.5",
                           "method.name=baumgarte", "method.damping=implicit", "method.gains=dead-beat"});
  ASSERT_TRUE(s.off_by_k.has_value());
  EXPECT_GT(*s.off_by_k, 6);
  EXPECT_NEAR((s.temperature - 298.15) / *s.off_by_k, 1, 0.4);
  ASSERT_EQ(s.doubts.size(), 1u);
  EXPECT_NE(s.doubts[0].find("which the thermostat leaves"), std::string::npos);
}

// A trap at the origin and forces around it, which have no potential: they feed energy for ever.
struct Swirl final : OwnField {
  explicit Swirl(double its_strength) : strength(its_strength) {}
  std::string name() const override { return "Swirl"; }
  double add(const Vectors& x, Vectors& f) override {
    f -= kStiffness * x;
    f.row(0) -= strength * x.row(1);
    f.row(1) += strength * x.row(0);
    return 0.5 * kStiffness * x.squaredNorm();
  }
  static constexpr double kStiffness = 100;
  double strength;
};

// Langevin's takes 1 − exp(−2γh) of what a degree of freedom has too much in a step: by weak friction and by
// strong, where that is well below 2γh.
TEST(Account, SaysHowFarADriftKeepsLangevinsThermostatOff) {
  for (const auto& [friction, strength] : {std::pair{5, 20}, {40, 170}}) {
    Scene scene = scene_of("trimer", {"build.chains=300", "method.name=none", "run.steps=6000",
                                      "run.log_every=10", "run.dt_fs=10", "run.thermostat=langevin",
                                      "run.friction_per_ps=" + std::to_string(friction)});
    scene.system.bonds.clear();
    Random random(7);
    for (auto x : scene.start.x.colwise())
      x = random.normal_vector() / std::sqrt(Swirl::kStiffness);  // kT = 1
    scene.terms.own.push_back(std::make_shared<Swirl>(strength));
    const double bath = scene.run.temperature_k;
    const Summary s = Simulation(std::move(scene)).run({});
    ASSERT_TRUE(s.off_by_k.has_value());
    EXPECT_GT(s.temperature - bath, 0.05 * bath) << friction;
    EXPECT_NEAR(*s.off_by_k / (s.temperature - bath), 1, 0.08) << friction;
  }
}

}  // namespace
}  // namespace taut::account_tests
