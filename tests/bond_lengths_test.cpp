// What taut crosscheck says of bond lengths beside OpenMM.

#include "studies/bond_lengths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/crosscheck.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::bond_lengths_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// OpenMM's own settings are rows. SETTLE's error is rounding to float, at any tolerance; CCMA's is the tolerance.
TEST(BondLengths, SayWhatTheyAreMadeOf) {
  const auto of = [](const char* scene, const std::vector<std::string>& overrides) {
    CrosscheckPlan plan;
    plan.contestants = contestants({"newton"});
    plan.speed_seconds = 0;
    return crosscheck(read_scene(find_scene(scene), overrides), plan);
  };
  const auto row = [](const Crosscheck& c, const std::string& run) {
    for (const BondLengths& each : bond_lengths(c))
      if (each.run == run) return each;
    ADD_FAILURE() << "no row " << run;
    return BondLengths();
  };
  const Crosscheck water = of("water", {"run.steps=20", "build.molecules=64", "forcefield.cutoff_nm=0.55",
                                        "forcefield.switch_nm=0.5"}),
                   chains = of("freely_jointed", {"build.chains=5", "run.steps=40"});
  EXPECT_EQ(water.settled, water.bonds);
  for (const char* run : {"openmm rattle, SETTLE", "openmm verlet 1e-05, SETTLE"}) {
    EXPECT_NEAR(row(water, run).rms.value / water.float_rounding, 1, 0.01) << run;
    EXPECT_THAT(row(water, run).made_of, HasSubstr("float"));
  }
  EXPECT_EQ(chains.settled, 0);
  const BondLengths usual = row(chains, "openmm verlet 1e-05, CCMA"),
                    tight = row(chains, "openmm verlet 1e-08, CCMA");
  EXPECT_LT(usual.largest, 1.1e-5);
  EXPECT_GT(usual.rms.value, 50 * tight.rms.value);
  EXPECT_THAT(usual.made_of, HasSubstr("CCMA"));
  for (const Crosscheck* c : {&water, &chains}) {
    EXPECT_LT(row(*c, "newton").rms.value, 1e-12);
    EXPECT_FALSE(row(*c, "newton").drifts);
    EXPECT_THAT(bond_lengths_in_words(*c), AllOf(HasSubstr("newton"), HasSubstr("5 ps"), HasSubstr("chaos")));
  }
  EXPECT_THAT(headline(chains), HasSubstr("agrees"));
}

TEST(BondLengths, SayThatTheyDrift) {
  Crosscheck c{.scene = "", .openmm = "", .platform = ""};
  c.bonds = 1, c.parting = 100;
  Track& track = c.tracks.emplace_back();
  track.name = "none";
  for (long n = 0; n <= 100; ++n)
    track.samples.push_back(
        {.step = n, .t = 1e-3 * static_cast<double>(n), .bond_rms = 1e-8 * static_cast<double>(n)});
  const BondLengths of = bond_lengths(c).at(0);
  EXPECT_NEAR(of.slope.value, 1e-8 / 1e-6, 1e-6 * of.slope.value);
  for (Sample& s : track.samples) s.bond_rms += s.step % 2 ? 1e-9 : 0;
  EXPECT_FALSE(bond_lengths(c).at(0).drifts) << "too short to tell";
  c.long_enough = true;
  EXPECT_TRUE(bond_lengths(c).at(0).drifts);
  EXPECT_GE(of.in_a_ns, of.slope.value);
}

}  // namespace
}  // namespace taut::bond_lengths_tests
