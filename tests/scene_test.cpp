// Scene files: what is read, what overrides do, which velocities count, and how scenes are found.

#include <algorithm>
#include <set>

#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/rattle.hpp"
#include "scene_text.hpp"

namespace taut::scene_tests {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Scene, ReadsWhatTheFileSays) {
  const Scene scene = read(SceneText{}.text);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.hard_on, "a test");
  EXPECT_EQ(scene.system.mass, Eigen::Vector3d(0, 1, 1.5));
  ASSERT_EQ(scene.system.bond_count(), 2);
  EXPECT_EQ(scene.system.bonds[1].i, 1);
  EXPECT_EQ(scene.system.bonds[1].j, 2);
  EXPECT_EQ(scene.start.x.col(2), Vec3(2, 0, 0));
  EXPECT_EQ(scene.start.v, Vectors::Zero(3, 3));
  EXPECT_EQ(scene.terms.gravity.value(), Vec3(0, -9.81, 0));
  ASSERT_EQ(scene.terms.pulls.size(), 1u);
  EXPECT_EQ(scene.terms.pulls[0].force, Vec3(1, 2, 3));
  EXPECT_EQ(scene.run.dt_fs, 0.5);
  EXPECT_EQ(scene.run.steps, 20);
  const auto& options = *scene.method.get_if<Baumgarte::Options>();
  EXPECT_EQ(options.alpha_per_ps, 3.0);
  EXPECT_EQ(options.beta_per_ps, std::nullopt);
  EXPECT_EQ(options.max_solves, 2);
}

// Every key a scene can have says what it means; numbers with a unit in their name say the same unit.
TEST(Scene, KeysAreDescribed) {
  const std::vector<Key> keys = every_key();
  std::set<std::string> names;
  for (const Key& key : keys) {
    EXPECT_STRNE(key.about.meaning, "") << key.name();
    EXPECT_NE(key.type, "") << key.name();
    names.insert(key.name());
  }
  for (const char* name : {"hard_on",
                           "build.kind",
                           "build.atoms",
                           "build.gravity_nm_ps2",
                           "build.chains",
                           "build.model",
                           "build.start",
                           "forcefield.pair",
                           "forcefield.coulomb",
                           "forcefield.pme_grid",
                           "forcefield.precision",
                           "run.dt_fs",
                           "run.coupling",
                           "method.name",
                           "method.gains",
                           "method.tolerance",
                           "method.omega_h",
                           "atom.NAME.mass_u",
                           "molecule.NAME.atoms",
                           "molecule.NAME.exclude",
                           "place.count",
                           "build.box_nm"})
    EXPECT_TRUE(names.contains(name)) << name;
  const auto one = [&](const std::string& name) { return *std::ranges::find(keys, name, &Key::name); };
  EXPECT_EQ(one("run.dt_fs").value, "1");
  EXPECT_STREQ(one("run.dt_fs").about.unit, "fs");
  EXPECT_EQ(one("run.dt_fs").allowed(), "more than 0");
  EXPECT_EQ(one("run.friction_per_ps").counts_only, "with run.thermostat = \"langevin\"");
  EXPECT_EQ(one("run.trajectory").allowed(), "one of dcd, h5md, both");
  EXPECT_EQ(one("build.kind").kinds.size(), 6u);
  EXPECT_TRUE(one("build.molecules").required);
  EXPECT_EQ(one("forcefield.precision").kinds,
            (std::vector<std::string>{"melt", "water", "lammps", "molecules"}));
  EXPECT_EQ(one("method.omega_h").kinds, std::vector<std::string>{"penalty"});
}

// Who said it, and what counts; what nothing reads is idle.
TEST(Scene, KeysSayWhereTheyCameFrom) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", SceneText{}.text);
  KeysRead read;
  read_scene(file, {"run.steps=7", "method.name=rattle", "method.tolerance=1e-7"}, {.keys = &read});
  const auto one = [&](const char* section, const char* key) { return read.of(section, key); };
  EXPECT_EQ(one("run", "dt_fs").value, "0.5");
  EXPECT_EQ(one("run", "dt_fs").from, file.string() + ":16");
  EXPECT_EQ(one("run", "steps").value, "7");
  EXPECT_EQ(one("run", "steps").from, "--set run.steps=7");
  EXPECT_EQ(one("run", "seed").from, "");
  EXPECT_EQ(one("method", "name").value, "\"rattle\"");
  EXPECT_EQ(one("method", "tolerance").value, "1e-07");
  EXPECT_FALSE(one("method", "max_solves").read);  // the file's, of another method
  EXPECT_TRUE(one("run", "friction_per_ps").idle);
  EXPECT_FALSE(one("run", "dt_fs").idle);
  EXPECT_EQ(one("build", "atoms").value, "3 rows");
  read_scene(file, {"run.thermostat=langevin", "run.temperature_k=300"}, {.keys = &read});
  EXPECT_FALSE(one("run", "friction_per_ps").idle);
}

TEST(Scene, OverridesPrevail) {
  const Scene scene =
      read(SceneText{}.text, {"run.dt_fs=2", "run.steps = 1e6", "method.gains=critical", "run.dt_fs=4"});
  EXPECT_EQ(scene.run.dt_fs, 4);
  EXPECT_EQ(scene.run.steps, 1000000);
  const auto& options = *scene.method.get_if<Baumgarte::Options>();
  EXPECT_EQ(options.gains, "critical");
  EXPECT_EQ(options.max_solves, 2);  // the file's own method: its other keys stay
}

TEST(Scene, AnotherMethodSetsTheFilesKeysAside) {
  const Scene scene = read(SceneText{}.text, {"method.tolerance=1e-6", "method.name=rattle"});
  const auto& options = *scene.method.get_if<Rattle::Options>();
  EXPECT_EQ(options.tolerance, 1e-6);
  EXPECT_EQ(options.max_sweeps, Rattle::Options{}.max_sweeps);
}

TEST(Scene, NamingTheFilesOwnMethodKeepsItsKeys) {
  const Scene scene = read(SceneText{}.text, {"method.name=\"baumgarte\""});
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->max_solves, 2);
}

TEST(Scene, OverridesOfASceneFromElsewhere) {
  Scene scene = read(SceneText{}.text);
  apply_overrides(scene, {"run.log_every=7", "method.max_solves=3"});
  EXPECT_EQ(scene.run.log_every, 7);
  EXPECT_EQ(scene.run.dt_fs, 0.5);
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->max_solves, 3);
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->alpha_per_ps, 3.0);
  EXPECT_THROW(apply_overrides(scene, {"build.molecules=7"}), InputError);
}

// A chain of the file's own: three atoms, of which two move.
std::string moving(const std::string& velocities, const std::string& run) {
  return SceneText{}.with("pulls", velocities + "pulls").with("steps = 20", run).text;
}
const std::string kMoving = "velocities = [[0, 0, 0], [0, 1, 0], [0, 2, 0]]\n";

TEST(Velocities, AreKeptWhereTheStartHasSomeAndDrawnWhereAsked) {
  const Scene kept = read(moving(kMoving, "steps = 20"));
  EXPECT_EQ(kept.start.v.col(2), Vec3(0, 2, 0));
  EXPECT_FALSE(kept.velocities_drawn);
  const Scene bath = read(moving(kMoving, "temperature_k = 300\nthermostat = \"langevin\""));
  EXPECT_EQ(bath.start.v.col(2), Vec3(0, 2, 0));
  const Scene drawn = read(moving(kMoving, "temperature_k = 300\nvelocities = \"draw\""));
  EXPECT_TRUE(drawn.velocities_drawn);
  EXPECT_NE(drawn.start.v.col(2), Vec3(0, 2, 0));
  EXPECT_EQ(drawn.start.v.col(0), Vec3::Zero());  // an anchor
  const Scene at_rest = read(moving("", "temperature_k = 300"));
  EXPECT_EQ(at_rest.start.v, drawn.start.v);
  const Scene stays = read(moving("", "temperature_k = 300\nthermostat_ps = 1\nvelocities = \"keep\""));
  EXPECT_EQ(stays.start.v, Vectors::Zero(3, 3));
  EXPECT_EQ(read(moving("", "steps = 20")).start.v, Vectors::Zero(3, 3));
}

TEST(Velocities, ATemperatureThatDoesNothingIsRefused) {
  EXPECT_THAT(
      complaint(moving(kMoving, "temperature_k = 300")),
      HasSubstr("scene.toml:18: run.temperature_k: has no effect, it counts only with a thermostat or "
                "run.velocities = \"draw\""));
  EXPECT_THAT(complaint(moving(kMoving, "steps = 20"), {"run.temperature_k=300"}),
              HasSubstr("--set run.temperature_k=300: run.temperature_k: has no effect"));
  EXPECT_THAT(complaint(moving(kMoving, "steps = 20"), {"run.seed=3"}), HasSubstr("run.seed: has no effect"));
  EXPECT_THAT(complaint(moving(kMoving, "velocities = \"draw\"")),
              HasSubstr("scene.toml:18: run.velocities: drawn at run.temperature_k, which is 0"));
  const std::string draws = moving(kMoving, "temperature_k = 300\nvelocities = \"draw\"");
  EXPECT_EQ(complaint(draws, {"run.seed=3"}), "no error");
  EXPECT_EQ(complaint(draws, {"run.velocities=keep"}), "no error");  // sets the file's temperature aside
  EXPECT_THAT(complaint(draws, {"run.velocities=keep", "run.temperature_k=200"}),
              HasSubstr("run.temperature_k: has no effect"));
}

// As a State of OpenMM's comes: with velocities, or without.
TEST(Velocities, OfASceneFromElsewhere) {
  Scene moves = read(moving(kMoving, "steps = 20")), rests = read(moving("", "steps = 20"));
  EXPECT_THROW(apply_overrides(moves, {"run.temperature_k=300"}), InputError);
  moves = read(moving(kMoving, "steps = 20"));
  apply_overrides(moves, {"run.temperature_k=300", "run.thermostat=langevin"});
  EXPECT_EQ(moves.start.v.col(2), Vec3(0, 2, 0));
  apply_overrides(rests, {"run.temperature_k=300", "run.thermostat=langevin"});
  EXPECT_TRUE(rests.velocities_drawn);
  apply_overrides(moves, {"run.velocities=draw"});
  EXPECT_EQ(moves.start.v, rests.start.v);
  apply_overrides(moves, {"run.seed=2"});
  EXPECT_NE(moves.start.v, rests.start.v);
  apply_overrides(rests, {"run.seed=2"});
  EXPECT_EQ(moves.start.v, rests.start.v);
}

TEST(SceneList, FindsScenesByNameAndPath) {
  const auto water = find_scene("water");
  EXPECT_EQ(water, scenes_folder() / "water.toml");
  EXPECT_EQ(find_scene(water.string()), water);
  EXPECT_EQ(error_message([&] { find_scene("watre"); }),
            "watre: no such file, and no scene of that name; did you mean \"water\"?");
  EXPECT_EQ(error_message([&] { find_scene("/tmp"); }), "/tmp: a folder, not a scene's file");
}

TEST(SceneList, ListsEverySceneAndNoStart) {
  const TemporaryFolder folder;
  folder.write("b.toml", "hard_on = 'second'");
  folder.write("a.toml", "hard_on = 'first'");
  folder.write("a.start.toml", "atoms = []");
  folder.write("notes.txt", "");
  const auto scenes = list_scenes(folder.path());
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[0].name, "a");
  EXPECT_EQ(scenes[0].hard_on, "first");
  EXPECT_EQ(scenes[1].name, "b");
}

}  // namespace
}  // namespace taut::scene_tests
