// Reading OpenMM's XML without OpenMM: what its serializer writes, what no serializer ever wrote, and keys laid over the
// forces of a System.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "file_text.hpp"
#include "forcefield/force_field.hpp"
#include "openmm_folder.hpp"
#include "openmm_texts.hpp"
#include "systems/openmm/import.hpp"
#include "systems/openmm/xml.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/scene_source.hpp"

namespace taut::openmm_reader_tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

double number_after(const std::string& text, const std::string& key, std::size_t from = 0) {
  return std::stod(text.substr(text.find(key, from) + key.size()));
}

double potential_of(const Texts& texts) {
  OpenMMInput input = read(texts);
  ForceField forces(input.system, input.start.box, input.terms);
  return forces.evaluate_energy(input.system, input.start);
}

TEST(OpenMMReader, HasTheEnergyAndForcesOpenMM86WroteOfEveryForce) {
  const Texts texts = every_force();
  OpenMMInput input = read(texts);
  ForceField forces(input.system, input.start.box, input.terms);
  const double ours = forces.evaluate_energy(input.system, input.start);
  const double theirs = number_after(texts.state, "PotentialEnergy=\"");
  EXPECT_NEAR(ours, theirs, 1e-9 * std::abs(theirs));
  auto at = texts.state.find("<Forces>");
  for (int a = 0; a < input.system.atoms(); ++a) {
    at = texts.state.find("<Force ", at) + 1;
    for (const auto& [c, key] : {std::pair(0, "x=\""), {1, "y=\""}, {2, "z=\""}})
      EXPECT_NEAR(input.start.f(c, a), number_after(texts.state, key, at), 1e-6) << "atom " << a;
  }
}

TEST(OpenMMReader, BindsParametersByTheirNames) {
  const OpenMMInput input = read(every_force());
  ASSERT_EQ(input.terms.fene.size(), 2u);
  EXPECT_EQ(input.terms.fene[0].k, 5000) << "of all, set in the State";
  EXPECT_LT(input.terms.fene[0].r0, 0.5);
  EXPECT_THAT(*input.terms.gravity, ElementsAre(-1.25, 0, -9.81));
  ASSERT_EQ(input.terms.pulls.size(), 2u);
  EXPECT_THAT(input.terms.pulls[0].force, ElementsAre(-2.5, 3, 1.5));
  EXPECT_EQ(input.terms.wca->sigma, 0.45);
  EXPECT_EQ(input.terms.wca->epsilon, 0.7);
}

TEST(OpenMMReader, TakesDefaultsWhereTheStateHasNoParameters) {
  Texts texts = every_force();
  replace(texts.state,
          "<Parameters AndersenCollisionFrequency=\"1.5\" AndersenTemperature=\"310\" bend=\"28.25\" "
          "epsilon=\".7\" fy=\"3\" gx=\"-1.25\" gy=\"0\" gz=\"-9.81\" k=\"5000\" sigma=\".45\"/>",
          "");
  const OpenMMInput input = read(texts);
  EXPECT_EQ(input.terms.fene[0].k, 4000);
  EXPECT_EQ(input.terms.gravity->x(), 0.5);
}

// It acts where there is a thermostat, and a run's own settings rule.
TEST(OpenMMReader, CarriesABarostatOutAtARunsTemperature) {
  Texts texts{text_of("tip3p-216.system.xml"), text_of("tip3p-216.state.xml")};
  replace(texts.system, "<Forces>",
          "<Forces><Force forceGroup=\"0\" frequency=\"25\" name=\"MonteCarloBarostat\" pressure=\"2\" "
          "randomSeed=\"0\" rigidScaling=\"1\" temperature=\"300\" type=\"MonteCarloBarostat\" "
          "version=\"1\"/>");
  const TemporaryFolder folder;
  const auto system = folder.write("a.system.xml", texts.system),
             state = folder.write("a.state.xml", texts.state);
  const auto run = [&](const std::vector<std::string>& overrides) {
    Scene scene = import_openmm(system, state);
    apply_overrides(scene, overrides);
    return scene.run;
  };
  const std::vector<std::string> warm = {"run.thermostat=langevin", "run.temperature_k=300"};
  EXPECT_FALSE(run({}).barostatted());
  EXPECT_TRUE(run(warm).barostatted());
  EXPECT_EQ(run(warm).barostat, "monte-carlo");
  EXPECT_EQ(run(warm).pressure_bar, 2);
  EXPECT_EQ(run(warm).barostat_every, 25);
  EXPECT_FALSE(run({warm[0], warm[1], "run.barostat=none"}).barostatted());
  EXPECT_EQ(run({warm[0], warm[1], "run.barostat=c-rescale", "run.pressure_bar=5"}).pressure_bar, 5);
  EXPECT_THROW(run({"run.barostat=monte-carlo"}), InputError);
  replace(texts.system, "<Forces>",
          "<Forces><Force energy=\"k*periodicdistance(x,y,z,x0,y0,z0)^2\" forceGroup=\"0\" name=\"hold\" "
          "type=\"CustomExternalForce\" version=\"1\"><PerParticleParameters><Parameter name=\"x0\"/>"
          "<Parameter name=\"y0\"/><Parameter name=\"z0\"/></PerParticleParameters><GlobalParameters>"
          "<Parameter default=\"500\" name=\"k\"/></GlobalParameters><Particles>"
          "<Particle index=\"3\" param1=\"0.1\" param2=\"0.2\" param3=\"0.3\"/></Particles></Force>");
  folder.write("a.system.xml", texts.system);
  EXPECT_EQ(run(warm).barostat, "monte-carlo");
  EXPECT_THROW(run({warm[0], warm[1], "run.barostat=c-rescale"}), InputError);
}

TEST(OpenMMReader, NotesABarostatThatScalesAtoms) {
  Texts texts = every_force();
  const auto barostat = [](const char* attribute) {
    return fmt::format(
        "<Forces><Force forceGroup=\"0\" frequency=\"25\" name=\"MonteCarloBarostat\" pressure=\"2\" "
        "randomSeed=\"0\" {}temperature=\"300\" type=\"MonteCarloBarostat\" version=\"1\"/>",
        attribute);
  };
  const auto notes = [&](const char* attribute) {
    Texts changed = texts;
    replace(changed.system, "<Forces>", barostat(attribute));
    return read(changed).notes;
  };
  const auto noted = ::testing::Contains(HasSubstr("force 0: MonteCarloBarostat has rigidScaling=\"0\""));
  EXPECT_THAT(notes("rigidScaling=\"0\" "), noted);
  EXPECT_THAT(notes("rigidScaling=\"1\" "), Not(noted));
  EXPECT_THAT(notes(""), Not(noted));  // before 8.4
}

// By the commands gzip and bzip2; the names of files are any.
TEST(OpenMMReader, ExpandsCompressedFiles) {
  const Texts texts = every_force();
  const TemporaryFolder folder;
  const auto system = folder.write("it's a.system.xml", texts.system),
             state = folder.write("a.state.xml", texts.state);
  const Scene plain = import_openmm(system, state);
  ASSERT_EQ(
      std::system(fmt::format("cd {} && gzip -k *.xml && bzip2 -k *.xml", folder.path().string()).c_str()),
      0);
  for (const char* ending : {".gz", ".bz2"}) {
    const XmlFile system_file(system.string() + ending, "System"),
        state_file(state.string() + ending, "State");
    const Scene scene = import_openmm(system_file, state_file);
    EXPECT_EQ(scene.start.x, plain.start.x);
    EXPECT_EQ(scene.name, "it's a");
    const SceneSource source = source_of(system_file, state_file, {});
    EXPECT_EQ(source.files[0].text, texts.system);
    EXPECT_EQ(source.read().start.x, plain.start.x);
    const auto cut =
        folder.write(std::string("cut.xml") + ending, contents(system.string() + ending).substr(0, 700));
    EXPECT_THAT(error_message([&] { import_openmm(cut, state); }),
                HasSubstr("cannot expand it: is it whole?"));
  }
  EXPECT_THAT(error_message([&] { import_openmm(folder.path() / "no.xml.gz", state); }),
              HasSubstr("no.xml.gz: cannot be read: No such file"));
}

// Each number of the files makes the energy or the forces what they are.
TEST(OpenMMReader, NoNumberOfAForceIsPassedOver) {
  const Texts texts = every_force();
  const double energy = potential_of(texts);
  const auto forces = texts.system.find("<Forces>");
  int tried = 0;
  for (const char* key : {" d=\"", " k=\"", " a=\"", " phase=\"", " c0=\"", " c1=\"", " c2=\"", " c3=\"",
                          " c4=\"", " c5=\"", " q=\"", " sig=\"", " eps=\"", " rfDielectric=\"",
                          " switchingDistance=\"", " param1=\"", " param2=\"", " e=\""}) {
    for (auto at = texts.system.find(key, forces); at != std::string::npos;
         at = texts.system.find(key, at + 1)) {
      const auto digits = at + std::string(key).size(), end = texts.system.find('"', digits);
      const double value = number_after(texts.system, key, at);
      Texts changed = texts;
      changed.system.replace(digits, end - digits, std::to_string(value * 1.03125));
      const std::string line = texts.system.substr(texts.system.rfind('\n', at) + 1, 90);
      if (value == 0 || value == -1 || line.find("eps=\"0\"") != std::string::npos) continue;  // no effect
      ++tried;
      EXPECT_NE(potential_of(changed), energy) << line;
    }
  }
  EXPECT_GT(tried, 100);
}

TEST(OpenMMReader, SaysWhetherTheStateHasVelocities) {
  Texts texts = every_force();
  const OpenMMInput with = read(texts);
  EXPECT_TRUE(with.has_velocities);
  EXPECT_EQ(with.start.v(1, 0), 0.3095);
  EXPECT_EQ(with.start.t, 2.5);
  EXPECT_EQ(with.start.v.col(11).norm(), 0) << "an anchor";
  const auto from = texts.state.find("<Velocities>"), to = texts.state.find("</Velocities>") + 13;
  texts.state.erase(from, to - from);
  const OpenMMInput without = read(texts);
  EXPECT_FALSE(without.has_velocities);
  EXPECT_EQ(without.start.v.norm(), 0);
}

TEST(OpenMMReader, SaysThatAnIntegratorsParametersAreNotUsed) {
  Texts texts = every_force();
  EXPECT_THAT(read(texts).notes, ElementsAre(HasSubstr("IntegratorParameters"), HasSubstr("Andersen")));
  replace(texts.state, "<IntegratorParameters version=\"1\"/>", "<IntegratorParameters/>");
  EXPECT_THAT(read(texts).notes,
              ElementsAre(one_line_with("AndersenThermostat (310 K, 1.5 collisions per ps) is left to")));
}

TEST(OpenMMReader, SumsEwaldsSumByMesh) {
  Texts texts = every_force();
  replace(texts.system, "method=\"2\" name=\"NonbondedForce\"", "method=\"3\" name=\"NonbondedForce\"");
  const OpenMMInput input = read(texts);
  ASSERT_TRUE(input.terms.nonbonded->pme);
  EXPECT_EQ(input.terms.nonbonded->pme->tolerance, 5e-4);
  EXPECT_THAT(input.notes, ::testing::Contains(HasSubstr("force 4: NonbondedForce is summed by PME")));
}

// What does not change the forces is no reason to refuse.
TEST(OpenMMReader, TakesGroupsNamesAndCommentsAsTheyAre) {
  Texts texts = every_force();
  const double energy = potential_of(texts);
  replace(texts.system, "forceGroup=\"0\"", "forceGroup=\"31\"");
  replace(texts.system, "name=\"springs\"", "name=\"a &quot;name&quot;\"");
  replace(texts.system, "ewaldTolerance=\".0005\"", "ewaldTolerance=\".001\"");
  replace(texts.system, "<Constraints>", "<!-- <Constraints> -->\n<Constraints>");
  EXPECT_EQ(potential_of(texts), energy);
}

// OpenMM takes images for a force only where usesPeriodic says so: else a molecule broken across the box is
// stretched across it.
TEST(OpenMMReader, MendsAMoleculeOnlyWhereOpenMMTakesImages) {
  Texts texts = every_force();
  replace(texts.state, "<Position x=\".6714\"", "<Position x=\"3.6714\"");  // atom 9
  EXPECT_THAT(refusal(texts),
              one_line_with("force 3: RBTorsionForce: torsion 0 (6-7-8-9) is broken across the box",
                            "usesPeriodic is 0"));
  replace(texts.system, "type=\"RBTorsionForce\" usesPeriodic=\"0\"",
          "type=\"RBTorsionForce\" usesPeriodic=\"1\"");
  EXPECT_NEAR(read(texts).start.x(0, 9), 0.6714, 1e-12);
  replace(texts.system, "exceptionsUsePeriodic=\"1\"", "exceptionsUsePeriodic=\"0\"");
  EXPECT_THAT(refusal(texts),
              one_line_with("force 4: NonbondedForce: exception", "(6-9) is broken across the box"));
}

// Dumbbells of 1.7 nm in a box of 2.4, and a chain whose ends are held 1.81 nm apart in one of 3: OpenMM's energies.
TEST(OpenMMReader, KeepsBondsLongerThanHalfTheBox) {
  const std::pair<const char*, double> cases[] = {{"long-dumbbells", -400.3521}, {"held-ends", -10.112225}};
  for (const auto& [name, energy] : cases) {
    const Texts texts{text_of(name + std::string(".system.xml")), text_of(name + std::string(".state.xml"))};
    EXPECT_NEAR(potential_of(texts), energy, 1e-6 * std::abs(energy)) << name;
    const OpenMMInput input = read(texts);
    for (const auto& [i, j, length] : input.system.bonds)
      EXPECT_NEAR((input.start.x.col(j) - input.start.x.col(i)).norm(), length, 1e-6) << name;
  }
}

// tests/data/NAME with these keys laid over it.
Scene read_over(const std::string& name, const std::vector<std::string>& overrides) {
  const tests::Files files = tests::data(name);
  Scene scene = import_openmm(files.system, files.state);
  scene.notes.clear();
  apply_overrides(scene, overrides);
  return scene;
}

std::string refuse_over(const std::string& name, const std::string& override_) {
  return error_message([&] { read_over(name, {override_}); });
}

Vectors forces_of(const Scene& scene) {
  State state = scene.start;
  state.f = Vectors::Zero(3, state.x.cols());
  ForceField forces(scene.system, state.box, scene.terms);
  forces.evaluate(scene.system, state);
  return state.f;
}

// Mixed precision is the engine's own figure, 1e-6 of rms, on what OpenMM prepared, too; it is no other model.
TEST(OpenMMOverrides, MixedPrecisionServesWhatOpenMMPrepared) {
  for (const char* name : {"tip3p-216", "ala2-hbonds-rf", "ala3-charmm36", "every-force"}) {
    const Scene exact = read_over(name, {}), mixed = read_over(name, {"forcefield.precision=mixed"});
    EXPECT_EQ(mixed.terms.precision, Precision::kMixed) << name;
    EXPECT_THAT(mixed.notes, IsEmpty()) << name;
    const Vectors f = forces_of(exact);
    const double apart = (forces_of(mixed) - f).norm() / f.norm();
    EXPECT_GT(apart, 1e-12) << name << ": nothing was computed in another precision";
    EXPECT_LT(apart, 1e-5) << name;
  }
}

TEST(OpenMMOverrides, ANoteSaysWhereTheModelIsNotTheSystems) {
  const Scene scene = read_over("tip3p-216", {"forcefield.cutoff_nm=0.7", "forcefield.coulomb=pme"});
  EXPECT_EQ(scene.terms.nonbonded->cutoff, 0.7);
  EXPECT_TRUE(scene.terms.nonbonded->pme);
  EXPECT_THAT(scene.notes,
              ::testing::Contains(HasSubstr("asks for a cutoff of 0.7 nm; the System has 0.9 nm")));
  EXPECT_THAT(scene.notes, ::testing::Contains(HasSubstr("Coulomb by PME; the System has a reaction field")));
}

TEST(OpenMMOverrides, WhatIsNotSaidStaysTheSystems) {
  const Nonbonded given = *read_over("ala2-hbonds-rf", {}).terms.nonbonded;
  const Nonbonded same = *read_over("ala2-hbonds-rf", {"forcefield.precision=double"}).terms.nonbonded;
  EXPECT_EQ(same.cutoff, given.cutoff);
  EXPECT_EQ(same.switch_distance, given.switch_distance);
  EXPECT_EQ(same.rf_dielectric, given.rf_dielectric);
  EXPECT_EQ(same.dispersion_correction, given.dispersion_correction);
  EXPECT_EQ(same.pme.has_value(), given.pme.has_value());
}

// A System's α and grid stay unless a tolerance is said, which chooses them anew.
TEST(OpenMMOverrides, ATolerancePutsTheSystemsAlphaAndGridAside) {
  Scene scene = read_over("tip3p-216", {});
  scene.terms.nonbonded->pme = PmeParameters{.alpha = 3.5, .grid = {20, 21, 24}};
  Scene other = scene;
  apply_overrides(scene, {"forcefield.pme_order=4"});
  EXPECT_EQ(scene.terms.nonbonded->pme->order, 4);
  EXPECT_EQ(scene.terms.nonbonded->pme->alpha, 3.5);
  EXPECT_THAT(scene.terms.nonbonded->pme->grid, ElementsAre(20, 21, 24));
  apply_overrides(other, {"forcefield.ewald_tolerance=1e-5"});
  EXPECT_EQ(other.terms.nonbonded->pme->alpha, 0);
  EXPECT_THAT(other.terms.nonbonded->pme->grid, ElementsAre(0, 0, 0));
}

TEST(OpenMMOverrides, PullsAndRestraintsActBesidesTheSystems) {
  const Scene bare = read_over("tip3p-216", {});
  const Scene held =
      read_over("tip3p-216", {"build.pulls=[[3, 100, 0, 0]]", "build.restraints=[[0, 1, 1, 1, 500]]"});
  const Vectors more = forces_of(held) - forces_of(bare);
  EXPECT_NEAR(more(0, 3), 100, 1e-9);
  EXPECT_GT(more.col(0).norm(), 1);
  EXPECT_EQ((more.colwise().norm().array() > 1e-9).count(), 2);
}

TEST(OpenMMOverrides, PullsChangeInTime) {
  const Scene pulled =
      read_over("tip3p-216", {"build.pulls=[[3, 100, 0, 0]]", "run.pull_factor=[[0, 0], [1, 2]]"});
  EXPECT_EQ(pulled.terms.pull_factor.at(0.5), 1);
  EXPECT_EQ(forces_of(pulled), forces_of(read_over("tip3p-216", {}))) << "the factor is 0 at the start";
  EXPECT_THAT(refuse_over("tip3p-216", "run.pull_factor=[[0, 0], [1, 2]]"),
              one_line_with("run.pull_factor", "with pulls"));
}

TEST(OpenMMOverrides, SteeredAtomsStartWhereTheyAre) {
  const Scene plain = read_over("tip3p-216", {}),
              steered = read_over("tip3p-216", {"build.steered=[[3, 0, 0, 0.01, 500]]"});
  EXPECT_EQ(steered.terms.steered.at(0).from, plain.start.x.col(3));
  EXPECT_EQ(forces_of(steered), forces_of(plain));
}

TEST(OpenMMOverrides, KeysThatCannotActAreRefusedWithTheReason) {
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.precison=mixed"), one_line_with("precison", "precision"));
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.pme_order=4"), one_line_with("coulomb = \"pme\""));
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.cutoff_nm=5"), one_line_with("cutoff_nm", "half the box"));
  EXPECT_THAT(refuse_over("tip3p-216", "build.molecules=5"), one_line_with("molecules"));
  EXPECT_THAT(refuse_over("tip3p-216", "build.pulls=[[9999, 1, 0, 0]]"), one_line_with("pulls"));
  Scene bonds = read_over("tip3p-216", {});
  bonds.terms.nonbonded.reset();
  EXPECT_THROW(apply_overrides(bonds, {"forcefield.precision=mixed"}), InputError);
  EXPECT_THROW(apply_overrides(bonds, {"forcefield.cutoff_nm=0.7"}), InputError);
}

}  // namespace
}  // namespace taut::openmm_reader_tests
