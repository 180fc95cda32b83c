// What a run says against itself: of figures that are made up, and of runs whose forces are not right.

#include "simulation/doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "md/units.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene_file.hpp"

namespace taut::doubts_tests {
namespace {

using ::testing::AllOf, ::testing::ElementsAre, ::testing::HasSubstr, ::testing::IsEmpty, ::testing::Not;
using Overrides = std::vector<std::string>;

Scene scene_of(const std::string& name, const Overrides& overrides) {
  return read_scene(find_scene(name), overrides);
}

// Of a run at 300 K of 1000 degrees of freedom over 10 ps.
Summary plain_summary() {
  Summary s;
  s.temperature = 300;
  s.start_and_end = {.time = 10, .rise = 0, .dof = 1000, .expected = 300, .temperature = {300, 2}};
  return s;
}

TEST(DoubtsOfStartAndEnd, OfAnEnergyThatEndsElsewhere) {
  Summary s = plain_summary();
  const double kT = kBoltzmann * 300;
  s.start_and_end.rise = 0.15 * kT;
  ASSERT_THAT(doubts(s),
              ElementsAre(HasSubstr("the energy ends 0.15 kT a degree of freedom above its start; ")));
  s.start_and_end.rise = -0.15 * kT;
  ASSERT_THAT(doubts(s), ElementsAre(HasSubstr("below its start; ")));
  s.start_and_end.loses_energy = true;
  EXPECT_THAT(doubts(s), IsEmpty());
  s.start_and_end = plain_summary().start_and_end;
  s.start_and_end.rise = 0.09 * kT;
  EXPECT_THAT(doubts(s), IsEmpty());
  s.start_and_end.rise = 0.15 * kT;
  s.start_and_end.time = 200;  // slow
  EXPECT_THAT(doubts(s), IsEmpty());
  s.start_and_end.time = 10;
  s.start_and_end.dof = 4;  // four degrees of freedom scatter by more
  EXPECT_THAT(doubts(s), IsEmpty());
  s.start_and_end.dof = 1000;
  s.drift = {0.15 * kT / 10 * 1000, 100};  // the line tells nothing
  s.off_by_k = 2.9;
  EXPECT_THAT(doubts(s), IsEmpty());
  s.off_by_k = 3.1;
  EXPECT_THAT(doubts(s),
              ElementsAre(HasSubstr("above its start, which the thermostat leaves 3.1 K too warm; ")));
}

TEST(DoubtsOfStartAndEnd, OfATemperatureFarFromTheStarts) {
  Summary s = plain_summary();
  const auto at = [&](double temperature) {
    s.start_and_end.temperature.value = temperature;
    return doubts(s);
  };
  const double most = 300 * (1.25 + 5 * std::sqrt(0.002));
  EXPECT_THAT(at(most - 1), IsEmpty());
  EXPECT_THAT(at(most + 1), ElementsAre(HasSubstr("the temperature went from 300 to 443.1 K; ")));
  EXPECT_THAT(at(85), IsEmpty());
  EXPECT_THAT(at(80), ElementsAre(HasSubstr("went from 300 to 80 K; ")));
  s.start_and_end.worked_on = true;
  EXPECT_THAT(at(80), IsEmpty());
  EXPECT_THAT(at(29000), IsEmpty());
  EXPECT_THAT(at(31000), ElementsAre(HasSubstr("pulls")));
  s.start_and_end.dof = 9;
  EXPECT_THAT(at(1e9), IsEmpty());
  s.start_and_end.dof = 1000;
  s.start_and_end.expected = 0;  // at rest
  EXPECT_THAT(at(1e9), IsEmpty());
}

TEST(DoubtsOfStartAndEnd, OfATemperatureFarFromTheBaths) {
  Summary s = plain_summary();
  StartAndEnd& ends = s.start_and_end;
  ends.relaxation = 0.5;
  ends.temperature = {316, 2};
  EXPECT_THAT(doubts(s),
              ElementsAre(HasSubstr("set to 300 K, and the mean temperature of the later half is 316 K")));
  EXPECT_THAT(doubts(s), ElementsAre(Not(HasSubstr("pull"))));
  ends.worked_on = true;
  EXPECT_THAT(doubts(s), ElementsAre(HasSubstr("a stronger thermostat, or pull more slowly: ")));
  ends.temperature.value = 284;
  EXPECT_THAT(doubts(s), ElementsAre(AllOf(HasSubstr("284 K"), Not(HasSubstr("pull")))));
  ends.worked_on = false;
  ends.temperature.error = 3.3;  // chance
  EXPECT_THAT(doubts(s), IsEmpty());
  ends.temperature = {314, 2};  // little
  EXPECT_THAT(doubts(s), IsEmpty());
  ends.temperature = {400, 2};
  ends.time = 9.9;  // not yet settled
  EXPECT_THAT(doubts(s), IsEmpty());
}

Summary summary_of(Scene scene) {
  return Simulation(std::move(scene)).run({});
}

// Whatever the line through the rows says: α that leaves most of Coulomb's sum out, a cutoff within the
// first shell of neighbours.
TEST(DoubtsOfRuns, OfForcesThatAreNotRight) {
  const Overrides short_run = {"run.steps=400", "run.log_every=20"};
  const auto with = [&](Overrides what) {
    what.insert(what.end(), short_run.begin(), short_run.end());
    return summary_of(scene_of("water", what)).doubts;
  };
  EXPECT_THAT(with({}), IsEmpty());
  EXPECT_THAT(with({"forcefield.coulomb=pme"}), IsEmpty());
  EXPECT_THAT(
      with({"forcefield.coulomb=pme", "forcefield.ewald_alpha_per_nm=0.001"}),
      ::testing::AllOf(::testing::Contains(HasSubstr("the temperature went from 300")),
                       ::testing::Contains(HasSubstr("α = 0.001/nm leaves forces wrong by about 0.5"))));
  EXPECT_THAT(with({"forcefield.cutoff_nm=0.3"}),
              ::testing::Contains(HasSubstr("the temperature went from 300")));
}

TEST(DoubtsOfRuns, OfAPullThatTearsAChainAway) {
  Scene scene = scene_of("trimer", {"build.chains=10", "run.steps=200", "run.log_every=10"});
  for (int a = 0; a < scene.system.atoms(); ++a) scene.terms.pulls.push_back({a, Vec3(1e5, 0, 0)});
  EXPECT_THAT(summary_of(std::move(scene)).doubts,
              ::testing::Contains(HasSubstr("the temperature went from")));
}

// The same is said before the run.
TEST(DoubtsOfRuns, NoteEwaldsErrorBeforeTheRun) {
  const auto notes = [](Overrides what) {
    what.push_back("forcefield.coulomb=pme");
    return Simulation(scene_of("water", what)).scene().notes;
  };
  EXPECT_THAT(notes({}), ::testing::Not(::testing::Contains(HasSubstr("Ewald"))));
  EXPECT_THAT(notes({"forcefield.ewald_alpha_per_nm=0.5"}),
              ::testing::Contains(HasSubstr("give no ewald_alpha_per_nm, or a larger one")));
  EXPECT_THAT(notes({"forcefield.pme_grid=[8, 8, 8]"}),
              ::testing::Contains(HasSubstr("give no pme_grid, or a finer one")));
}

// Nothing is said against any scene of taut's, with or without a bath.
TEST(DoubtsOfRuns, NotOfTheScenes) {
  const std::vector<Overrides> baths = {{},
                                        {"run.thermostat=langevin", "run.temperature_k=300"},
                                        {"run.thermostat_ps=0.1", "run.temperature_k=300"}};
  for (const char* name :
       {"diatomic", "double_pendulum", "pair", "pendulum", "trimer", "water", "water_cluster", "spce", "melt",
        "methane", "heme", "off_manifold", "mass_ratio", "fold", "knee", "planted_foot"})
    for (Overrides all : baths) {
      const std::string bath = all.empty() ? "" : all[0];
      const bool worlds =
          std::string(name) == "fold" || std::string(name) == "knee" || std::string(name) == "planted_foot";
      if (!bath.empty() && worlds) continue;
      all.insert(all.end(), {"run.steps=200", "run.log_every=10"});
      EXPECT_THAT(summary_of(scene_of(name, all)).doubts, IsEmpty()) << name << " " << bath;
    }
}

}  // namespace
}  // namespace taut::doubts_tests
