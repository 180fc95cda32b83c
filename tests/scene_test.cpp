// Scene files: what is read, what overrides do, which velocities count, and how scenes are found. Starts: written and read
// back, fitted to a scene, refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/errors.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/rattle.hpp"
#include "error_message.hpp"
#include "named_scene.hpp"
#include "polymer_scene.hpp"
#include "scene_text.hpp"
#include "systems/scene/start_file.hpp"
#include "temporary_folder.hpp"

namespace taut::scene_tests {
namespace {

using testing::HasSubstr;

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
  for (const char* name : {"hard_on", "build.chains", "run.coupling", "method.omega_h", "atom.NAME.mass_u",
                           "molecule.NAME.exclude", "place.count"})
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
  const SceneText struts =
      SceneText{}
          .with("pulls =", "at_least = [[0, 2, 1]]\npulls =")
          .with("name = \"baumgarte\"\nalpha_per_ps = 3.0\nmax_solves = 2", "sweeps = 4");
  const Scene unnamed =
      read(struts.text, {"method.name=rattle"});  // what one-sided bonds take unless they say another
  EXPECT_EQ(unnamed.method.get_if<Rattle::Options>()->sweeps, 4);
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

std::string water_start() {
  return "build.start=" + (scenes_folder() / "water216.start.toml").string();
}

TEST(Start, ReadsBackExactlyAndContinues) {
  const TemporaryFolder folder;
  Scene scene = scene_of("melt");
  scene.start.x.array() += 1.0 / 3;
  const auto file = folder.path() / "final.start.toml";
  write_start(file, scene.start);
  const State back = read_start(file);
  EXPECT_EQ(back.x, scene.start.x);
  EXPECT_EQ(back.v, scene.start.v);
  EXPECT_EQ(back.box.edge, scene.start.box.edge);

  // The scene draws velocities for the start it ships with; another's are kept, with a thermostat and
  // without.
  for (const char* thermostat : {"run.thermostat=none", "run.thermostat=langevin"}) {
    const Scene next = scene_of("melt", {"build.start=" + file.string(), thermostat});
    EXPECT_EQ(next.start.x, scene.start.x);
    EXPECT_EQ(next.start.v, scene.start.v);
  }
  const Scene drawn = scene_of("melt", {"build.start=" + file.string(), "run.velocities=draw", "run.seed=2"});
  EXPECT_EQ(drawn.start.x, scene.start.x);
  EXPECT_EQ(drawn.start.v, scene_of("melt", {"run.seed=2"}).start.v);
}

// One that somebody asked for is not set aside in silence.
TEST(Start, ThatAnOverrideNamesHasToFit) {
  const auto complaint = [](const std::string& scene, const std::vector<std::string>& overrides) {
    return error_message([&] { scene_of(scene, overrides); });
  };
  using testing::HasSubstr;
  const std::string melt = "build.start=" + (scenes_folder() / "melt.start.toml").string();
  EXPECT_THAT(complaint("melt", {melt, "build.chains=21"}), HasSubstr("it has another number of atoms"));
  EXPECT_THAT(
      complaint("water_cluster", {"build.start=" + (scenes_folder() / "water_cluster.start.toml").string(),
                                  "build.molecules=100"}),
      HasSubstr("build.start: a droplet of 64, which serves for a droplet of as many alone"));
  EXPECT_EQ(complaint("water", {water_start(), "build.molecules=1728"}), "no error");
}

// Other counts or another density than the start's: what was built stands, and a note says so.
TEST(Start, IsSetAsideWhereItDoesNotFit) {
  using testing::ElementsAre;
  using testing::HasSubstr;
  EXPECT_THAT(scene_of("melt").notes, testing::IsEmpty());
  const auto notes = [](const std::vector<std::string>& overrides) {
    return scene_of("melt", overrides).notes;
  };
  EXPECT_THAT(notes({"build.chains=21"}),
              ElementsAre(HasSubstr("melt"), HasSubstr("another number of atoms")));
  EXPECT_THAT(notes({"build.density_per_nm3=0.8"}), ElementsAre(HasSubstr("melt"), HasSubstr("another box")));
  const std::vector<std::string> longer = {"build.chains=10", "build.beads=100"};
  EXPECT_THAT(notes(longer), ElementsAre(HasSubstr("melt"), HasSubstr("other bonds")));
  EXPECT_THAT(notes({longer[0], longer[1], "build.bonds=fene"}),
              ElementsAre(HasSubstr("melt"), HasSubstr("other springs")));
}

TEST(Start, KeepsASkewedBoxToTheBit) {
  const TemporaryFolder folder;
  State s;
  s.x = s.v = Vectors::Random(3, 2);
  s.box = {Vec3(2, 1.9, 1.7), Vec3(-1.0 / 3, 0.7, -0.1)};
  write_start(folder.path() / "skewed.start.toml", s);
  EXPECT_EQ(read_start(folder.path() / "skewed.start.toml").box, s.box);
}

// A start is gone on from as it is: nothing is placed, so that nothing may lack room, and nothing is relaxed unless
// somebody asks.
TEST(Start, OfMoleculesThatWerePushedApartIsGoneOnFrom) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "crowd.toml", kCrowd + kPartTheCrowd + "velocities = \"draw\"\nminimise_force_kj_mol_nm = 500\n");
  State end = read_scene(file).start;
  end.v = Vectors::Random(3, 30);
  write_start(folder.path() / "end.start.toml", end);
  const auto go_on = [&](std::vector<std::string> overrides) {
    overrides.push_back("build.start=" + (folder.path() / "end.start.toml").string());
    return read_scene(file, overrides);
  };
  EXPECT_THAT(error_message([&] { read_scene(file, {"run.minimise=false"}); }),
              testing::HasSubstr("there is no room for copy 2 of 3"));
  for (const bool said : {false, true}) {
    const Scene next =
        go_on(said ? std::vector<std::string>{"run.minimise=false"} : std::vector<std::string>{});
    EXPECT_EQ(next.start.x, end.x);
    EXPECT_EQ(next.start.v, end.v);
    EXPECT_FALSE(next.run.minimise || next.run.soft_start || next.positions_drawn || next.velocities_drawn);
    const auto set_aside =
        testing::HasSubstr("run.minimise is set aside: build.start is gone on from as it is");
    if (said)
      EXPECT_THAT(next.notes, testing::IsEmpty());
    else
      EXPECT_THAT(next.notes, testing::ElementsAre(set_aside));
  }
  const Scene asked = go_on({"run.minimise=true"});
  EXPECT_TRUE(asked.run.minimise && !asked.run.soft_start);
  EXPECT_EQ(asked.run.minimise_force, 500);
  EXPECT_TRUE(go_on({"run.minimise=true", "run.soft_start=true"}).run.soft_start);
  end.v.setZero();
  write_start(folder.path() / "end.start.toml", end);
  EXPECT_TRUE(go_on({}).velocities_drawn);
}

// Of water that fills a box the start knows how much there is.
TEST(Start, CountsTheWaterThatFilledItsBox) {
  const TemporaryFolder folder;
  const std::string wet = with(with(kPolymers, "[build]", "[[place]]\nmolecule = \"tip3p\"\n[build]"),
                               "box_nm = 5", "box_nm = 2.5");
  const auto file = folder.write("wet.toml", wet);
  const Scene first = read_scene(file, {"run.seed=5"});
  write_start(folder.path() / "end.start.toml", first.start);
  const Scene next = read_scene(file, {"build.start=" + (folder.path() / "end.start.toml").string()});
  EXPECT_EQ(next.start.x, first.start.x);
  EXPECT_EQ(next.names.residue, first.names.residue);
}

// Springs longer than they can be: a chain's start whose bonds of 0.97 are stretched past r₀ = 1.5.
TEST(Start, DoesNotFitWhereASpringCannotReach) {
  const TemporaryFolder folder;
  Scene scene = scene_of("melt", {"build.bonds=fene"});
  const auto read = [&](double stretch) {
    State s = scene.start;
    s.x.col(0) = s.x.col(1) + stretch * Vec3(s.x.col(0) - s.x.col(1)).normalized();
    write_start(folder.path() / "long.start.toml", s);
    return scene_of("melt",
                    {"build.bonds=fene", "build.start=" + (folder.path() / "long.start.toml").string()});
  };
  EXPECT_THAT(read(1.49).notes, testing::IsEmpty());
  EXPECT_THROW(read(1.51), InputError);
}

TEST(Start, SaysWhatIsWrongWithIt) {
  const TemporaryFolder folder;
  for (const auto& [text, words] :
       {std::pair{"atoms = [\n[1, 2, 3, 4, 5, 6],\n[1, 2, 3]]",
                  "bad.start.toml:3: atoms[1]: expected 6 numbers"},
        {"box_nm = [1, 2, 0]\natoms = []", "bad.start.toml:1: box_nm: edges of 1 x 2 x 0 nm"},
        {"box_nm = [1, 2, 3, 4]\natoms = []", "box_nm: expected 3 numbers, its edges, or 9, its vectors"},
        {"box_nm = [2, 0, 0, 1.1, 2, 0, 0, 0, 2]\natoms = []", "bx = 1.1 nm, expected at most half of ax"},
        // halves of five decimals, as .gro files have them
        {"box_nm = [3.12345, 0, 0, 0, 3.12345, 0, 1.56173, 1.56173, 2.20861]\natoms = []", "no error"},
        {"atoms = [[1, 2, 3, 4, 5, inf]]", "atoms[0]: expected finite numbers"},
        {"box_nm = [1, 1, 1]", "bad.start.toml: missing key \"atoms\""},
        {"atoms = []\nbox = 1", "bad.start.toml:2: unknown key \"box\"; did you mean \"box_nm\"?"}}) {
    const auto file = folder.write("bad.start.toml", text);
    EXPECT_THAT(error_message([&] { read_start(file); }), testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace taut::scene_tests
