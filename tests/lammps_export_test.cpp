// LAMMPS data files out, back in again, and the energy that LAMMPS finds for them.

#include "lammps_files.hpp"
#include "md/units.hpp"

namespace taut::lammps_export_tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using tests::kMixture;
using Folder = tests::LammpsFolder;
using tests::total;

// The round trip keeps atoms, velocities, bonds and energies. Two styles of a kind are hybrid, which taut does not
// read: here one kind of angles stays.
void expect_back(const std::string& kept) {
  SceneText text = SceneText{kMixture}.with("rb_torsions", "# rb_torsions");
  for (const char* angles : {"angles = [[0", "cosine_angles", "cosine_squared_angles"})
    if (angles != kept) text = text.with(angles, std::string("# ") + angles);
  const Scene plain = read(text.text, {"run.temperature_k=300"});
  const Folder folder;
  write_lammps(plain, folder.folder.path() / "a");
  const Scene back = folder.read_back("rigid_bonds = [1]\nspecial_lj = [0, 0, 0.5]\nmix = \"arithmetic\"",
                                      "cutoff_nm = 1.1");
  ASSERT_EQ(back.system.atoms(), 100);
  EXPECT_LT((back.start.v - plain.start.v).norm(), 1e-14);
  EXPECT_EQ(back.system.bond_count(), 40);
  EXPECT_EQ((back.system.mass - plain.system.mass).norm(), 0);
  const Energies here = energies_of(plain), there = energies_of(back);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_EQ(here[k].first, there[k].first);
    EXPECT_NEAR(here[k].second, there[k].second, 1e-10 * std::abs(here[k].second) + 1e-20);
  }
}

TEST(LammpsExport, GoesOutAndBack) {
  for (const char* kept : {"angles = [[0", "cosine_angles", "cosine_squared_angles"}) expect_back(kept);
  const Scene scene = read(kMixture, {"run.temperature_k=300"});
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  // exceptions have no cutoff in taut, and none of these pairs is beyond LAMMPS's
  const double of_lammps = folder.of_lammps().energy;
  EXPECT_NEAR(of_lammps, total(energies_of(scene)), 1e-9 * std::abs(of_lammps));
}

// LAMMPS puts splines of its own through the rows of tables, of bonds, angles and pairs, beside rigid bonds and
// Lennard-Jones.
TEST(LammpsExport, TablesGoOut) {
  const Scene scene = scene_of("coarse_grained");
  const LammpsFiles files = lammps_files(scene, "a.data");
  for (const char* said :
       {"bond_style hybrid harmonic table spline 20000\n", "angle_style table spline 20000\n",
        "pair_style hybrid lj/cut 1.2 table spline 20000\n"})
    EXPECT_THAT(files.input, HasSubstr(said));
  for (const char* said : {"table a.table BOND1\n", "1 a.table ANGLE2\n", "1 1 table a.table PAIR3 1.2\n"})
    EXPECT_THAT(files.data, HasSubstr(said));
  EXPECT_THAT(files.tables, testing::StartsWith("# coarse_grained.bond.csv\nBOND1\nN 1501 FP 0 0 EQ 0.36"));
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  const double here = total(energies_of(scene));
  const auto [energy, forces] = folder.of_lammps();
  EXPECT_NEAR(energy, here, 1e-7 * std::abs(here));
  State s = scene.start;
  ForceField(scene.system, s.box, scene.terms).evaluate(scene.system, s);
  EXPECT_NEAR(forces, s.f.norm(), 1e-6 * s.f.norm());
}

// Energy and, where no anchor bears some, forces are LAMMPS's.
void expect_lammps_agrees(const Scene& scene) {
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  const double here = total(energies_of(scene));
  const auto [energy, forces] = folder.of_lammps();
  EXPECT_NEAR(energy, here, 1e-8 * std::abs(here)) << scene.name;
  State s = scene.start;
  ForceField(scene.system, s.box, scene.terms).evaluate(scene.system, s);
  if (scene.system.anchors() > 0) return;
  EXPECT_NEAR(forces, s.f.norm(), 1e-7 * s.f.norm()) << scene.name;
}

// Between walls, whose slit need not begin where the box does; and with anchors, gravity, walls and impropers without a
// box.
TEST(LammpsExport, WhatActsFromOutsideGoesOut) {
  const Scene slit = scene_of("slit");
  expect_lammps_agrees(slit);
  const LammpsFiles files = lammps_files(slit, "a.data");
  EXPECT_THAT(files.data, HasSubstr("-0.29999999999999982 4.2999999999999998 zlo zhi"));
  EXPECT_THAT(files.input, HasSubstr("group before1 type 1\n"));
  EXPECT_THAT(files.input, HasSubstr("fix wall1 before1 wall/lj93 zhi 4 2 0.46999999999999997 "));
  EXPECT_THAT(files.input, HasSubstr(" units box pbc yes\nfix_modify wall1 energy yes\n"));

  const std::string held =
      SceneText{kMixture}
          .with("box_nm = 2.6", "gravity_nm_ps2 = [0.5, 0, -2]")
          .with("lennard_jones_14 = 0.5",
                "lennard_jones_14 = 0.5\nimpropers = [[0, 1, 2, 3, 0, 40], [1, 2, 3, 4, 180, 30]]")
          .with("count = 20", "count = 2\nwithin_nm = [0, 0, 1, 2, 2, 3]")
          .with("[build]",
                "[atom.C]\nmass_u = 0\nsigma_nm = 0.3\nepsilon_kj_mol = 0.4\n"
                "[molecule.floor]\natoms = [\"C\"]\n[[place]]\nmolecule = "
                "\"floor\"\ncount = 3\nwithin_nm = [0, 0, 0.2, 2, 2, 0.6]\n[[wall]]\naxis = "
                "\"z\"\nabove_nm = 0\nsigma_nm = 0.3\nepsilon_kj_mol = 3\natoms = [\"B\"]\n[build]")
          .text;
  const Scene scene = read(held, {"run.temperature_k=300"});
  EXPECT_EQ(scene.system.anchors(), 3);
  EXPECT_EQ(scene.terms.harmonic_torsions.size(), 4u);
  expect_lammps_agrees(scene);
  const std::string input = lammps_files(scene, "a.data").input;
  for (const char* said : {"group anchors type 3\ngroup moving subtract all anchors\n",
                           "fix integrate moving nve\n", "fix gravity moving gravity 2.061552812808830",
                           "group before0 type 2\n", " fixed anchors\n", "improper_style harmonic\n",
                           "fix wall0 before0 wall/lj93 zlo 0 3 0.29999999999999999 1000000 units box\n"})
    EXPECT_THAT(input, HasSubstr(said));
}

TEST(LammpsExport, AMeltWithFeneGoesOutAndBack) {
  const Scene melt =
      scene_of("melt", {"build.bonds=\"fene\"", "build.chains=10", "build.beads=20", "run.steps=0"});
  const Folder folder;
  write_lammps(melt, folder.folder.path() / "a");
  if (std::system("lmp -h > /dev/null 2>&1") == 0) {
    EXPECT_NEAR(folder.of_lammps().energy, total(energies_of(melt)),
                1e-9 * std::abs(total(energies_of(melt))));
  }
  const Scene back = folder.read_back("special_lj = [0, 1, 1]", "pair = \"wca\"");
  EXPECT_NEAR(total(energies_of(back)), total(energies_of(melt)), 1e-10 * std::abs(total(energies_of(melt))));
}

// Water of four sites is pair_style tip4p's, without atoms M. On a fine mesh energies agree.
TEST(LammpsExport, WaterOfFourSitesGoesOut) {
  const Scene water =
      scene_of("water", {"build.model=tip4pew", "forcefield.coulomb=pme", "forcefield.cutoff_nm=0.9",
                         "forcefield.ewald_tolerance=1e-9", "forcefield.dispersion_correction=false"});
  const LammpsFiles files = lammps_files(water, "a.data");
  EXPECT_THAT(files.data, HasSubstr("648 atoms\n2 atom types\n648 bonds\n2 bond types\n216 angles\n"));
  EXPECT_THAT(files.input, HasSubstr("pair_style lj/cut/tip4p/long 1 2 1 1 0.0125000"));
  EXPECT_THAT(files.input, HasSubstr("kspace_style pppm/tip4p 0.1389\n"));
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(water, folder.folder.path() / "a");
  const double here = total(energies_of(water));
  EXPECT_NEAR(
      folder.of_lammps("pair_modify table 0\nkspace_modify gewald 4.2 mesh 60 60 60 order 7\n").energy, here,
      5e-6 * std::abs(here));
}

// What the input does otherwise than the scene stands in its comments.
TEST(LammpsExport, TheInputSaysWhatItLeavesOut) {
  const auto input = [](const std::vector<std::string>& overrides) {
    std::vector<std::string> all = {"build.chains=3", "build.beads=10"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return lammps_files(scene_of("melt", all), "a.data").input;
  };
  const std::string plain = input({"method.name=feedforward"});
  for (const char* absent : {"method.name", "barostat", "minimise", "momentum", "dump", "csvr", "langevin"})
    EXPECT_THAT(plain, Not(HasSubstr(absent)));
  EXPECT_THAT(input({"method.name=newton"}),
              HasSubstr("# - method.name = \"newton\" holds the bonds in taut"));
  const std::string rescaled =
      input({"run.thermostat=rescaling", "run.thermostat_ps=0.5", "run.barostat=c-rescale",
             "run.minimise=true", "run.remove_momentum_every=7", "run.trajectory_every=10"});
  for (const char* said :
       {"\nfix bath all temp/csvr ", " 0.5 ", "# - velocity rescaling", "# - run.barostat = \"c-rescale\"",
        "# - run.minimise", "# - run.remove_momentum_every is left out: fix momentum 7",
        "# - run.trajectory_every"})
    EXPECT_THAT(rescaled, HasSubstr(said));
  EXPECT_THAT(input({"run.thermostat=langevin", "run.friction_per_ps=0"}),
              AllOf(Not(HasSubstr("fix bath")), HasSubstr("# - run.friction_per_ps = 0 leaves")));
  EXPECT_THAT(
      input({"run.thermostat=langevin", "run.friction_per_ps=4"}),
      AllOf(HasSubstr("\nfix bath all langevin "), HasSubstr(" 0.25 "), HasSubstr("# - Langevin dynamics")));
}

// fix shake stops on chains: "Shake clusters are connected".
TEST(LammpsExport, TheInputOffersFixShakeWhereItHoldsTheBonds) {
  const auto input = [](const std::string& bonds) {
    return lammps_files(read(fmt::format(R"(
[build]
kind = "atoms"
atoms = [[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [-1, 0, 0, 1]]
bonds = [{}]
)",
                                         bonds)),
                        "a.data")
        .input;
  };
  const char* may = "fix shake or rattle may stand in its place";
  EXPECT_THAT(input("[0, 1, 1]"), HasSubstr(may));
  EXPECT_THAT(input("[0, 1, 1], [0, 2, 1], [0, 3, 1]"), HasSubstr(may));
  for (const char* bonds :
       {"[0, 1, 1], [0, 2, 1], [0, 3, 1], [0, 4, 1]", "[1, 0, 1], [0, 2, 1], [2, 3, 1.4142135623730951]",
        "[0, 1, 1], [0, 2, 1], [1, 2, 1.4142135623730951]"})
    EXPECT_THAT(input(bonds), AllOf(HasSubstr("cannot stand in its place"), Not(HasSubstr(may)))) << bonds;
}

TEST(LammpsExport, WhatLammpsLacksIsRefusedByName) {
  const auto refused = [](const std::string& name,
                          const std::vector<std::string>& overrides = {}) -> std::string {
    return error_message([&] { lammps_files(scene_of(name, overrides), "a.data"); });
  };
  EXPECT_EQ(refused("decane"), "no error");
  EXPECT_EQ(refused("pendulum"), "no error");
  const std::vector<std::string> pme = {"forcefield.coulomb=pme"};
  EXPECT_EQ(refused("water", {"build.model=tip4pew", pme[0]}), "no error");
  EXPECT_THAT(refused("water", {"build.model=tip5p", pme[0]}),
              HasSubstr("atom 3 is a virtual site, and LAMMPS has"));
  EXPECT_THAT(refused("fold"), HasSubstr("LAMMPS cannot express it"));
  EXPECT_THAT(refused("water"), HasSubstr(": a reaction field; take forcefield.coulomb = \"pme\""));
  EXPECT_THAT(refused("chain"), HasSubstr(": a switch of Lennard-Jones; leave forcefield.switch_nm out"));
}

}  // namespace
}  // namespace taut::lammps_export_tests
