// What a run says against itself: of figures that are made up, and of runs whose forces are not right.

#include "simulation/doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "md/units.hpp"
#include "named_scene.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"

namespace taut::doubts_tests {
namespace {

using ::testing::AllOf, ::testing::ElementsAre, ::testing::HasSubstr, ::testing::IsEmpty, ::testing::Not;
using Overrides = std::vector<std::string>;

// Of a run at 300 K of 1000 degrees of freedom over 10 ps.
Summary plain_summary() {
  Summary s;
  s.temperature = 300;
  s.start_and_end = {
      .time = 10, .rise = 0, .dof = 1000, .expected = 300, .temperature = {300, 2}, .kinds = {}};
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
              ElementsAre(HasSubstr("set to 300 K, and the mean temperature over the later half is 316 K")));
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

TEST(DoubtsOfKinds, NameTheKindThatIsOff) {
  Summary s = plain_summary();
  StartAndEnd& ends = s.start_and_end;
  ends.relaxation = 0.5;
  ends.kinds = {{"90 molecules of 3 atoms", 900, 300, {301, 2}},
                {"2 molecules of 74 atoms", 100, 300, {279, 3}}};
  EXPECT_THAT(doubts(s),
              ElementsAre(AllOf(HasSubstr("of 2 molecules of 74 atoms over the later half is 279 K; "),
                                HasSubstr("take method newton"))));
  ends.kinds[0].temperature.value = 330;  // farther off
  EXPECT_THAT(doubts(s), ElementsAre(HasSubstr("of 90 molecules of 3 atoms over the later half is 330 K")));
  ends.temperature.value = 327;  // and so is the whole
  EXPECT_THAT(doubts(s), ElementsAre(HasSubstr("over the later half is 327 K")));
  ends.temperature.value = 300;
  ends.kinds[0].temperature.value = 301;
  ends.kinds[1].temperature.error = 4.3;  // chance
  EXPECT_THAT(doubts(s), IsEmpty());
}

// Without a bath a kind that ends where all do may have started elsewhere.
TEST(DoubtsOfKinds, WithoutABathAreOfThoseThatPartFromTheRest) {
  Summary s = plain_summary();
  s.start_and_end.kinds = {{"2 molecules of 74 atoms", 100, 20, {300, 3}}};
  EXPECT_THAT(doubts(s), IsEmpty());
  s.start_and_end.kinds[0] = {"2 molecules of 74 atoms", 100, 300, {20, 3}};
  EXPECT_THAT(doubts(s),
              ElementsAre(HasSubstr("the temperature of 2 molecules of 74 atoms went from 300 to 20 K")));
}

// What is at rest is judged by the system's own energies.
TEST(DoubtsOfStartAndEnd, OfWhatIsAtRestAreNotOfRounding) {
  Summary s = plain_summary();
  s.temperature = 1e-20;
  s.start_and_end.temperature = {1e-20, 0};
  s.start_and_end.expected = 0;
  s.start_and_end.rounding = 1e-6;
  s.start_and_end.rise = -1e-9;
  s.drift = {-1e-7, 1e-9};
  s.constraint_drift = {-1e-7, 1e-9};
  EXPECT_THAT(doubts(s), IsEmpty());
  s.drift.value = s.constraint_drift.value = -1e-5;
  EXPECT_THAT(doubts(s), ElementsAre(HasSubstr("the constraints cool by 1e-05 kJ/mol a nanosecond")));
  s.constraint_drift = {};
  EXPECT_THAT(doubts(s), ElementsAre(HasSubstr("the energy drifts by -1e-05 kJ/mol a nanosecond")));
  s.drift = {};
  s.start_and_end.rise = -0.5;
  EXPECT_THAT(doubts(s),
              ElementsAre(HasSubstr("the energy ends 0.5 kJ/mol a degree of freedom below its start")));
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

// Eight beads and a weight hang from an anchor: the bonds bear what is below them.
TEST(DoubtsOfRuns, NotOfAChainThatHangsAtRest) {
  const SceneText chain{R"(hard_on = "a test"
run = {dt_fs = 1, steps = 3000, log_every = 60}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [0, -1, 0, 1], [0, -2, 0, 1], [0, -3, 0, 1], [0, -4, 0, 1], [0, -5, 0, 1], [0, -6, 0, 1],
  [0, -7, 0, 1], [0, -8, 0, 1000]]
bonds = [[0, 1, 1], [1, 2, 1], [2, 3, 1], [3, 4, 1], [4, 5, 1], [5, 6, 1], [6, 7, 1], [7, 8, 1]]
gravity_nm_ps2 = [0, -9.81, 0]
)"};
  for (const char* method : {"newton", "feedforward", "baumgarte", "mshake", "none"}) {
    Simulation simulation(read(chain.text, {std::string("method.name=") + method}));
    EXPECT_THAT(simulation.run({}).doubts, IsEmpty()) << method;
    EXPECT_NEAR(simulation.bond_tensions()[0], 9.81 * 1007, 1e-5) << method;
    EXPECT_NEAR(simulation.bond_tensions()[7], 9.81 * 1000, 1e-5) << method;
  }
}

// LINCS without its expansion holds single bonds, and takes energy out of rings, which are few beside them.
TEST(DoubtsOfRuns, OfAKindOfMoleculeThatAMethodCools) {
  const SceneText mixture{R"(hard_on = "a test"
[atom.A]
mass_u = 12
[molecule.ring]
atoms = ["A", "A", "A", "A", "A", "A"]
bonds = [[0, 1, 0.15], [1, 2, 0.15], [2, 3, 0.15], [3, 4, 0.15], [4, 5, 0.15], [5, 0, 0.15]]
[molecule.pair]
atoms = ["A", "A"]
bonds = [[0, 1, 0.15]]
[[place]]
molecule = "ring"
count = 10
[[place]]
molecule = "pair"
count = 100
[build]
box_nm = 8
[run]
temperature_k = 300
thermostat = "langevin"
friction_per_ps = 0.02
dt_fs = 16
steps = 60000
log_every = 20
)"};
  EXPECT_THAT(summary_of(read(mixture.text, {"method.name=newton"})).doubts, IsEmpty());
  EXPECT_THAT(summary_of(read(mixture.text, {"method.name=lincs", "method.order=0"})).doubts,
              ::testing::Contains(AllOf(HasSubstr("set to 300 K"),
                                        HasSubstr("of 10 molecules of 6 atoms over the later half is"))));
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
