// Scenes with forcefield.coulomb.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "error_message.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::coulomb_tests {
namespace {

using ::testing::HasSubstr;
using Keys = std::vector<std::string>;

Nonbonded pairs_of(const Keys& keys) {
  return *read_scene(find_scene("water"), keys).terms.nonbonded;
}

std::string complaint(const Keys& keys) {
  return error_message([&] { pairs_of(keys); });
}

TEST(CoulombKeys, AreRead) {
  EXPECT_FALSE(pairs_of({}).pme);
  EXPECT_FALSE(pairs_of({"forcefield.coulomb=reaction-field"}).pme);
  EXPECT_EQ(pairs_of({"forcefield.coulomb=reaction-field", "forcefield.rf_dielectric=5"}).rf_dielectric, 5);
  EXPECT_EQ(pairs_of({"forcefield.coulomb=cutoff"}).rf_dielectric, 1) << "1/r − 1/rc, the force as it is";
  const auto pme = pairs_of({"forcefield.coulomb=pme", "forcefield.pme_order=6",
                             "forcefield.ewald_alpha_per_nm=3", "forcefield.pme_grid=[20, 24, 25]"})
                       .pme;
  ASSERT_TRUE(pme);
  EXPECT_EQ(pme->order, 6);
  EXPECT_EQ(pme->alpha, 3);
  EXPECT_EQ(pme->grid, (std::array{20, 24, 25}));
}

TEST(CoulombKeys, SayMartinisForm) {
  const Nonbonded pairs =
      pairs_of({"forcefield.dispersion_correction=false", "forcefield.shift=true", "forcefield.dielectric=15",
                "forcefield.rf_dielectric=0", "forcefield.rf_excluded=true"});
  EXPECT_TRUE(pairs.shifted && pairs.rf_excluded);
  EXPECT_EQ(pairs.dielectric, 15);
  EXPECT_EQ(pairs.rf_dielectric, HUGE_VAL) << "0 is infinite, as in GROMACS";
  EXPECT_THAT(complaint({"forcefield.rf_dielectric=0.5"}),
              HasSubstr("expected 1 or more, or 0 for infinite"));
  EXPECT_THAT(complaint({"forcefield.shift=true", "forcefield.dispersion_correction=true"}),
              HasSubstr("forcefield.shift: raises what ends at the cutoff"));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.rf_excluded=true"}),
              HasSubstr("forcefield.rf_excluded: has no effect"));
}

TEST(CoulombKeys, ThatHaveNoEffectOrCannotBeAreRefused) {
  EXPECT_THAT(complaint({"forcefield.coulomb=ewald"}), HasSubstr("reaction-field, cutoff, pme"));
  EXPECT_THAT(
      complaint({"forcefield.ewald_tolerance=1e-4"}),
      HasSubstr(
          "forcefield.ewald_tolerance: has no effect, it counts only with forcefield.coulomb = \"pme\""));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.rf_dielectric=5"}),
              HasSubstr("forcefield.rf_dielectric: has no effect"));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.ewald_tolerance=1e-14"}),
              HasSubstr("forcefield.ewald_tolerance: pme: a tolerance of 1e-14"));
  EXPECT_THAT(
      complaint({"forcefield.coulomb=pme", "forcefield.ewald_tolerance=1e-5",
                 "forcefield.ewald_alpha_per_nm=3", "forcefield.pme_grid=[20, 24, 25]"}),
      HasSubstr("forcefield.ewald_tolerance: has no effect, it counts only where ewald_alpha_per_nm or "
                "pme_grid is left to it"));
  for (const char* one : {"forcefield.ewald_alpha_per_nm=3", "forcefield.pme_grid=[20, 24, 25]"})
    EXPECT_EQ(pairs_of({"forcefield.coulomb=pme", "forcefield.ewald_tolerance=1e-5", one}).pme->tolerance,
              1e-5);
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.pme_order=9"}),
              HasSubstr("order 9, expected 4 to 8"));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.pme_grid=[20, 20.5, 20]"}),
              HasSubstr("three whole numbers"));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "forcefield.pme_grid=[3, 20, 20]"}),
              HasSubstr("fewer than the order"));
  EXPECT_THAT(complaint({"forcefield.coulomb=pme", "build.shape=droplet", "build.molecules=30"}),
              HasSubstr("pme needs a box"));
}

// What a run gains in 1 ps, an atom [kJ/mol], where neither the cutoff nor the mesh has a jump to speak of.
TEST(CoulombRun, PmeKeepsTheEnergy) {
  for (const char* method : {"newton", "feedforward"})
    for (const char* precision : {"double", "mixed"}) {
      Scene scene =
          read_scene(find_scene("water"), {"forcefield.coulomb=pme", "forcefield.ewald_tolerance=1e-5",
                                           "forcefield.switch_nm=0.75", "run.dt_fs=1", "run.steps=1000",
                                           std::string("forcefield.precision=") + precision,
                                           std::string("method.name=") + method});
      Simulation simulation(scene);
      const double before = simulation.record().total();
      const double gain = (simulation.run({}).total - before) / scene.system.atoms();
      EXPECT_LT(std::abs(gain), 1e-3) << method << " " << precision;  // of 3.7 kJ/mol an atom
    }
}

}  // namespace
}  // namespace taut::coulomb_tests
