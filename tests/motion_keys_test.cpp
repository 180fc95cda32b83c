// What [[motion]] refuses, and what it notes: motions beyond the reach of bonds, unresolved by the step, or without effect.

#include "scene_text.hpp"
#include "simulation/simulation.hpp"

namespace taut::motion_keys_tests {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

const SceneText kPendulum{R"([build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [1, 0, 0, 1]]
bonds = [[0, 1, 1]]
[[motion]]
atoms = [0]
velocity_nm_ps = [0.3, 0.5, 0.1]
[run]
dt_fs = 1
steps = 1000
)"};
constexpr const char* kVelocity = "velocity_nm_ps = [0.3, 0.5, 0.1]";

TEST(MovingAnchors, BeyondTheReachOfTheirBondsAreRefused) {
  EXPECT_EQ(complaint(kApart.text), "no error");
  EXPECT_THAT(
      complaint(kApart.text, {"run.steps=1000"}),
      HasSubstr("motion.0.atoms: atom 2 is 2.00017 nm from anchor 0 at 0.4002 ps, and the bonds between them "
                "reach 2 nm: move it less far, or take fewer run.steps"));
}

std::vector<std::string> notes_of(const std::string& motion, const std::vector<std::string>& settings = {}) {
  return Simulation(read(kPendulum.with(kVelocity, motion).text, settings)).scene().notes;
}

// At kTimes even times it would be where it was.
TEST(MovingAnchors, WhoseShakeDividesTheRunAreSeenBeyondReach) {
  const std::string shaken =
      kApart.with("velocity_nm_ps = [1, 0, 0]", "shake_nm = [0.5, 0, 0], period_ps = 0.02").text;
  for (const char* steps : {"20", "1000", "20000", "40000"})
    EXPECT_THAT(complaint(shaken, {std::string("run.steps=") + steps}),
                HasSubstr("motion.0.atoms: atom 2 is 2."))
        << steps;
}

TEST(MovingAnchors, FasterThanTheStepAreNoted) {
  const auto resolved = Each(Not(HasSubstr("resolve")));
  EXPECT_THAT(notes_of("shake_nm = [0.001, 0, 0]\nperiod_ps = 0.0063"), resolved);
  for (const char* period : {"0.0062", "0.002", "0.001", "0.0001"})
    EXPECT_THAT(notes_of(std::string("shake_nm = [0.001, 0, 0]\nperiod_ps = ") + period),
                Contains(HasSubstr("run.dt_fs: 1 fs does not resolve motion 0, whose ωh is ")))
        << period;
  const char* turn = "turn_deg_ps = [0, 0, 60000]\nabout_nm = [0, 0, 0]";  // ωh = 1.05
  EXPECT_THAT(notes_of(turn),
              Contains(AllOf(HasSubstr("motion 0, whose ωh is 1 "), HasSubstr("take 0.48 fs or less"))));
  EXPECT_THAT(notes_of(turn, {"run.dt_fs=0.48"}), resolved);
  const char* rows = "way_nm = [[0, 0, 0, 0], [0.5, 0.1, 0, 0], [0.502, 0.1, 0, 0]]";
  EXPECT_THAT(notes_of(rows), resolved);
  EXPECT_THAT(
      notes_of(rows, {"run.dt_fs=1.1"}),
      Contains(HasSubstr("motion.0.way_nm: run.dt_fs: 1.1 fs does not resolve rows that are 2 fs apart; "
                         "take 1 fs or less")));
}

TEST(MovingAnchors, ThatStandInTheRunAreNoted) {
  const auto noted = Contains(HasSubstr("motion.0.way_nm: nothing moves in this run, from 0 to 1 ps"));
  EXPECT_THAT(notes_of("way_nm = [[1, 0, 0, 0], [2, 1, 0, 0]]"), noted);
  EXPECT_THAT(notes_of("way_nm = [[-2, 0, 0, 0], [0, 1, 0, 0]]"), noted);
  EXPECT_THAT(notes_of("way_nm = [[0.9, 0, 0, 0], [2, 1, 0, 0]]"), Not(noted));
  EXPECT_THAT(notes_of("way_nm = [[-2, 0, 0, 0], [0.1, 1, 0, 0]]"), Not(noted));
}

TEST(MovingAnchors, ThatStartWithAnotherVelocityAreNoted) {
  const auto told = [](const std::string& velocities) {
    return Simulation(read(kPendulum.with("bonds =", velocities + "\nbonds =").text)).scene().notes;
  };
  const auto noted = Contains(HasSubstr("atom 0 is anchored (mass 0): the velocity it had was left out"));
  EXPECT_THAT(told(""), Not(noted));
  EXPECT_THAT(told("velocities = [[0, 0, 0], [0, 1, 0]]"), Not(noted));
  EXPECT_THAT(told("velocities = [[0.3, 0.5, 0.1], [0, 1, 0]]"), Not(noted));  // its own, as a run goes on
  EXPECT_THAT(told("velocities = [[0.3, 0.4, 0.1], [0, 1, 0]]"), noted);
}

TEST(MovingAnchors, BadMotionsAreRefusedByName) {
  const std::string also = std::string(kVelocity) + "\n";
  expect_said(
      kPendulum,
      {{"atoms = [0]\n", "atoms = [1]\n", "motion.0.atoms[0]: atom 1 has a mass of 1 u, and forces move it"},
       {"atoms = [0]\n", "atoms = [0, 0]\n", "motion.0.atoms[1]: atom 0 moves already"},
       {"atoms = [0]\n", "atoms = [5]\n", "motion.0.atoms[0]: there is no atom 5, only 0 to 1"},
       {"atoms = [0]\n", "atoms = [\"W\"]\n", "motion.0.atoms[0]: no atom is called \"W\""},
       {"atoms = [0]\n", "atoms = []\n", "motion.0.atoms: expected the atoms that move"},
       {kVelocity, also + "way_nm = [[0, 0, 0, 0], [1, 1, 0, 0]]",
        "motion.0.way_nm: expected either this or velocity_nm_ps"},
       {kVelocity, "velocity_nm_ps = [0, 0, 0]", "motion.0.velocity_nm_ps: expected a vector that is not 0"},
       {kVelocity, "", "motion.0.atoms: expected velocity_nm_ps, turn_deg_ps, shake_nm or way_nm"},
       {kVelocity, "way_nm = [[0, 0, 0, 0], [2, 1, 0, 0], [1, 0, 0, 0]]",
        "motion.0.way_nm[2]: a time of 1 ps after 2 ps, expected rising times"},
       {kVelocity, "way_nm = [[0, 0, 0, 0]]", "motion.0.way_nm: expected two rows"},
       {kVelocity, "way_nm = [[0, 1, 0, 0], [1, 1, 0, 0]]", "motion.0.way_nm: all rows have one place"},
       {kVelocity, "way_nm = [[0, 0, 0]]", "motion.0.way_nm[0]: expected 4 numbers, got 3"},
       {kVelocity, "turn_deg_ps = [0, 0, 1]", "motion.0.turn_deg_ps: expected about_nm"},
       {kVelocity, "shake_nm = [0, 0, 1]", "motion.0.shake_nm: expected period_ps"},
       {kVelocity, also + "about_nm = [0, 0, 0]",
        "motion.0.about_nm: has no effect, it counts only with turn_deg_ps"},
       {kVelocity, also + "period_ps = 1", "motion.0.period_ps: has no effect"},
       {kVelocity, "speed = 1", "unknown key \"speed\" in [motion.0]"},
       {"[1, 0, 0, 1]", "[1, 0, 0, 0]", "both its atoms are anchored"}});
}

}  // namespace
}  // namespace taut::motion_keys_tests
