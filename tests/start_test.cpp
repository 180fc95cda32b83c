// Starts: written and read back, fitted to a scene, refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "named_scene.hpp"
#include "polymer_scene.hpp"
#include "systems/scene/start_file.hpp"
#include "temporary_folder.hpp"

namespace taut::start_tests {
namespace {

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
  const auto complaint = [&](const std::string& text) -> std::string {
    const auto file = folder.write("bad.start.toml", text);
    return folder.without_path(error_message([&] { read_start(file); }));
  };
  EXPECT_EQ(complaint("atoms = [\n[1, 2, 3, 4, 5, 6],\n[1, 2, 3]]"),
            "bad.start.toml:3: atoms[1]: expected 6 numbers, got 3");
  EXPECT_EQ(complaint("box_nm = [1, 2, 0]\natoms = []"),
            "bad.start.toml:1: box_nm: edges of 1 x 2 x 0 nm, expected more than 0");
  EXPECT_EQ(complaint("box_nm = [1, 2, 3, 4]\natoms = []"),
            "bad.start.toml:1: box_nm: expected 3 numbers, its edges, or 9, its vectors; got 4");
  EXPECT_EQ(
      complaint("box_nm = [2, 0, 0, 1.1, 2, 0, 0, 0, 2]\natoms = []"),
      "bad.start.toml:1: box_nm: bx = 1.1 nm, expected at most half of ax = 2 nm: take whole vectors off it");
  EXPECT_EQ(complaint("box_nm = [3.12345, 0, 0, 0, 3.12345, 0, 1.56173, 1.56173, 2.20861]\natoms = []"),
            "no error");  // halves of five decimals, as .gro files have them
  EXPECT_EQ(complaint("atoms = [[1, 2, 3, 4, 5, inf]]"),
            "bad.start.toml:1: atoms[0]: expected finite numbers");
  EXPECT_EQ(complaint("box_nm = [1, 1, 1]"), "bad.start.toml: missing key \"atoms\"");
  EXPECT_EQ(complaint("atoms = []\nbox = 1"),
            "bad.start.toml:2: unknown key \"box\"; did you mean \"box_nm\"?");
}

}  // namespace
}  // namespace taut::start_tests
