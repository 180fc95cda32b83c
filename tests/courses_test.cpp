// Temperatures and pulls that change in time along straight lines.

#include <gmock/gmock.h>

#include "base/smooth_course.hpp"
#include "kept_state.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"

namespace taut::courses_tests {
namespace {

TEST(SmoothCourse, GoesThroughItsPointsWithContinuousVelocityAndIsAtRestAtBothEnds) {
  const SmoothCourse way(
      {{1, {0, 0, 0}}, {1.5, {1, 0, 2}}, {3, {0, 1, -1}}, {3.2, {0, 2, 0}}, {5, {1, 1, 1}}});
  EXPECT_EQ(way.at(1.5).place, Vec3(1, 0, 2));
  EXPECT_LT((way.at(3.2).place - Vec3(0, 2, 0)).norm(), 1e-14);
  for (const double end : {0.0, 1.0, 5.0, 9.0}) EXPECT_LT(way.at(end).velocity.norm(), 1e-14) << end;
  EXPECT_EQ(way.at(9).place, Vec3(1, 1, 1));
  const double e = 1e-6;
  for (const double t : {1.0, 1.2, 1.5, 3.0, 3.1, 3.2, 4.0, 5.0}) {
    const auto before = way.at(t - e), after = way.at(t + e);
    EXPECT_LT((after.velocity - before.velocity).norm(), 1e-3) << t;
    EXPECT_LT(((after.place - before.place) / (2 * e) - way.at(t).velocity).norm(), 1e-4) << t;
    if (t == 1 || t == 5) continue;
    EXPECT_LT((after.acceleration - before.acceleration).norm(), 1e-3) << t;
    EXPECT_LT(((after.velocity - before.velocity) / (2 * e) - way.at(t).acceleration).norm(), 1e-3) << t;
  }
}

TEST(Course, IsConstantOutsideAndStraightBetween) {
  const Course course({{10, 300}, {20, 400}, {40, 100}});
  EXPECT_EQ(course.at(0), 300);
  EXPECT_EQ(course.at(10), 300);
  EXPECT_DOUBLE_EQ(course.at(13), 330);
  EXPECT_DOUBLE_EQ(course.at(30), 250);
  EXPECT_EQ(course.at(99), 100);
  EXPECT_EQ(course.rate(5), 0);
  EXPECT_DOUBLE_EQ(course.rate(10), 5);
  EXPECT_DOUBLE_EQ(course.rate(11), 10);
  EXPECT_DOUBLE_EQ(course.rate(25), -15);
  EXPECT_EQ(course.rate(40.1), 0);
  EXPECT_DOUBLE_EQ(course.mean(0, 20), (10 * 300 + 10 * 350) / 20.0);
  EXPECT_DOUBLE_EQ(course.mean(15, 50), (5 * 375 + 20 * 250 + 10 * 100) / 35.0);
}

const std::string kGas =
    R"(molecule.dumbbell = {atoms = [{name = "A", mass_u = 10}, {name = "B", mass_u = 20}], bonds = [[0, 1, 0.1]]}
place = [{molecule = "dumbbell", count = 400}]
build = {box_nm = 12}
[run]
dt_fs = 5
steps = 800
log_every = 10
temperature_k = [[0, 200], [2, 200], [4, 600]]
thermostat = "langevin"
)";

const std::vector<std::vector<std::string>> kBaths = {
    {"run.thermostat=\"langevin\"", "run.friction_per_ps=50"},
    {"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.02"},
    {"run.thermostat=\"langevin\"", "run.friction_per_ps=50", "run.barostat=\"c-rescale\"",
     "run.pressure_bar=6", "run.compressibility_per_bar=0.1"}};

// Before 2 ps at 200 K; the mean over the last picosecond is that of the line from 400 to 600 K, 2400 degrees of
// freedom's fluctuations and the bath's delay of 0.02 ps away from it.
TEST(Annealing, TheTemperatureFollowsItsRows) {
  for (const auto& bath : kBaths) {
    Simulation simulation(read(kGas, bath));
    RunningMean before, end;
    simulation.run([&](const Record& r) {
      if (r.t > 1 && r.t < 2) before.add(r.temperature);
      if (r.t > 3) end.add(r.temperature);
      EXPECT_NEAR(*r.bath_temperature, r.t < 2 ? 200 : 200 + 200 * (r.t - 2), 1e-6);
    });
    EXPECT_NEAR(before.estimate().value, 200, 8) << bath[0];
    EXPECT_NEAR(end.estimate().value, 500 - 4, 20) << bath[0];
  }
}

TEST(Annealing, GoesOnFromACheckpointToTheLastBit) {
  for (const auto& bath : kBaths) {
    std::vector<std::string> all = bath;
    all.insert(all.end(), {"run.steps=500", "build.box_nm=12"});
    SCOPED_TRACE(bath[0]);
    expect_to_go_on_from(read(kGas, all), 450);
  }
}

TEST(Annealing, BadRowsAreRefusedByName) {
  for (const auto& [rows, words] :
       {std::pair{"[[0, 300], [1, 200]]", "no error"},
        {"[[0, 300]]", "no error"},
        {"[[0, 300], [0, 200]]", "[1]: expected rising times of 0 or more"},
        {"[[-1, 300]]", "rising times of 0 or more"},
        {"[[0, 300], [1, -2]]", "run.temperature_k[1]: expected at least 0, got -2"},
        {"[[0, 300], [1, 0]]", "[1]: expected a temperature above 0"},
        {"[300, 400]", "expected a time in ps and a number, as"},
        {"[]", "expected at least one row"},
        {"\"hot\"", "expected a number, or rows"}})
    expect_said_of(kGas,
                   {{{"run.thermostat=\"langevin\"", std::string("run.temperature_k=") + rows}, words}});
  expect_said_of(kGas, {{{"run.thermostat=\"none\""}, "no thermostat follows rows of time and temperature"},
                        {{"run.pull_factor=[[0, 1]]"}, "run.pull_factor: has no effect"}});
}

const std::string kPulled = R"(molecule.bead = {atoms = [{name = "B", mass_u = 50}], pulls = [[0, 30, 0, 40]]}
place = [{molecule = "bead", centres_nm = [[1, 2, 3]]}]
run = {dt_fs = 1, steps = 4000, log_every = 800, pull_factor = [[1, 0], [3, 1]]}
method = {name = "rattle"}
)";

// A free bead under a force that grows from 1 to 3 ps: a = t'/2 F/m, so x = F t'³/(12 m), then at constant force.
// The energy but for the work of changing the force stays.
TEST(ChangingPulls, AFreeBeadIsPulledEverHarder) {
  Simulation simulation(read(kPulled));
  simulation.run([&](const Record& r) {
    const double grown = std::clamp(r.t - 1, 0.0, 2.0), held = std::max(0.0, r.t - 3);
    const double speed = grown * grown / 4 + held;
    EXPECT_NEAR(r.kinetic, 0.5 * 50 * speed * speed, 1e-4);
    EXPECT_NEAR(*r.steering_force, 50 * grown / 2, 1e-9);
    EXPECT_NEAR(r.but_for_heat(), 0, 1e-4) << r.t;
  });
  const double way = 8.0 / 12 + 1.0 + 0.5;
  EXPECT_NEAR(simulation.state().x(0, 0), 1 + 0.6 * way, 1e-5);
  EXPECT_NEAR(simulation.state().x(2, 0), 3 + 0.8 * way, 1e-5);
}

}  // namespace
}  // namespace taut::courses_tests
