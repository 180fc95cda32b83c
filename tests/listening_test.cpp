// Long work listens all through, and whatever listening throws ends it: nothing is left of it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "base/listen.hpp"
#include "forcefield/force_field.hpp"
#include "named_scene.hpp"
#include "simulation/open_run.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/start_file.hpp"
#include "temporary_folder.hpp"

namespace taut::listening_tests {
namespace {

namespace fs = std::filesystem;

struct Stop {};

// Does the work under a listener that throws at the first call, then under one that throws at the second, third, fifth ...,
// as long as any is reached. Returns how often `work` hears.
template <class Work>
long count_stops(const Work& work) {
  for (long last = 1;; last += 1 + last / 2) {
    long calls = 0;
    const ListenScope scope([&] {
      if (++calls == last) throw Stop{};
    });
    try {
      work();
      return calls;
    } catch (const Stop&) {
      EXPECT_EQ(calls, last);
    }
  }
}

SceneSource large_openmm() {
  const OpenMMInput water = openmm_input(scene_of("water", {"build.molecules=1728"}));
  return {true, {{"a.system.xml", openmm_system_xml(water)}, {"a.state.xml", openmm_state_xml(water)}}, {}};
}

// 1728 waters: 5184 atoms, bonds, positions, velocities and exceptions each, so that a list has some five stops.
TEST(Listening, EndsReadingOpenMMsFilesAnywhere) {
  const SceneSource source = large_openmm();
  const Vectors whole = source.read().start.x;
  EXPECT_GT(count_stops([&] { EXPECT_EQ(source.read().start.x, whole); }), 60);
}

// They may be larger than what room there is for temporary files.
TEST(Listening, OpenMMsFilesAreReadWithoutAnyOfItsOwn) {
  const char* const usual = std::getenv("TMPDIR");
  const std::string before = usual ? usual : "";
  setenv("TMPDIR", "/dev/null", 1);
  EXPECT_NO_THROW(large_openmm().read());
  usual ? setenv("TMPDIR", before.c_str(), 1) : unsetenv("TMPDIR");
}

class InAFolder : public testing::Test {
 protected:
  void SetUp() override {
    const char* const usual = std::getenv("TMPDIR");
    if (usual) before_ = usual;
    setenv("TMPDIR", folder_.path().c_str(), 1);
  }
  void TearDown() override { before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR"); }

  TemporaryFolder folder_;
  std::optional<std::string> before_;
};

using Listening_InAFolder = InAFolder;

TEST_F(Listening_InAFolder, LeavesNoTemporaryFilesOfAScene) {
  const SceneSource source = source_of(scene_of("water"), {});
  ASSERT_EQ(source.files.size(), 2u);
  EXPECT_GT(count_stops([&] { (void)source.read(); }), 5);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

// A run is opened after one that was stopped, and finds nothing of it.
TEST_F(Listening_InAFolder, LeavesARunsFolderAsItWas) {
  const fs::path out = folder_.path() / "out";
  const auto open = [&] {
    Scene scene = scene_of("water", {"run.minimise=true"});
    RunRequest request{.folder = out, .threads = 1};
    request.source = source_of(scene, {"run.minimise=true"});
    request.scene = std::move(scene);
    EXPECT_FALSE(fs::exists(out));
    (void)open_run(std::move(request));
    fs::remove_all(out);
  };
  EXPECT_GT(count_stops(open), 8);
}

TEST_F(Listening_InAFolder, LeavesTheRunThatItWouldGoOnWith) {
  const fs::path out = folder_.path() / "out";
  Scene scene = scene_of("water", {"run.steps=2"});
  RunRequest begin{.folder = out, .threads = 1};
  begin.source = source_of(scene, {"run.steps=2"});
  begin.scene = std::move(scene);
  {
    OpenRun run = open_run(std::move(begin));
    run.folder->begin(*run.simulation);
  }
  const std::vector<std::string> files = run_files(out);
  const auto resume = [&] {
    EXPECT_EQ(run_files(out), files);
    (void)open_run({.mode = RunMode::kResume, .folder = out, .threads = 1});
  };
  EXPECT_GT(count_stops(resume), 8);
}

// 3000 atoms, some 300 kB.
TEST_F(Listening_InAFolder, EndsReadingAStartAnywhere) {
  State many;
  many.x = Vectors::Random(3, 3000), many.v = Vectors::Random(3, 3000);
  const fs::path file = folder_.path() / "a.start.toml";
  write_start(file, many);
  EXPECT_GT(count_stops([&] { EXPECT_EQ(read_start(file).x, many.x); }), 20);
}

// Where an evaluation of forces has been ended, the next has the bits of one that follows none.
TEST(Listening, EndsForcesAnywhere) {
  const Scene scene = scene_of("water", {"build.molecules=1728"});
  State s = scene.start;
  ForceField(scene.system, s.box, scene.terms).evaluate(scene.system, s);
  const Vectors f = s.f;
  const long stops = count_stops([&] {
    ForceField forces(scene.system, s.box, scene.terms);
    const auto expect_forces = [&] {
      const ListenScope deaf;
      forces.evaluate(scene.system, s);
      EXPECT_EQ(s.f, f);
    };
    try {
      (void)forces.evaluate_energy(scene.system, s);
    } catch (const Stop&) {
      expect_forces();
      throw;
    }
    expect_forces();
  });
  EXPECT_GT(stops, 20) << "columns of clusters";
  ForceField listed(scene.system, s.box, scene.terms);
  listed.evaluate(scene.system, s);
  EXPECT_GE(count_stops([&] { (void)listed.evaluate_energy(scene.system, s); }), 4);
}

// What each builder is long at.
TEST(Listening, EndsBuildingAnywhere) {
  const auto stops = [](const std::string& scene, const std::vector<std::string>& overrides) {
    return count_stops([&] { (void)read_scene(find_scene(scene), overrides); });
  };
  EXPECT_GT(stops("water", {"build.molecules=500"}), 10) << "is cut and relaxed";
  EXPECT_GT(stops("decane", {"place.0.count=120"}), 120);
  EXPECT_GT(stops("freely_jointed", {"build.chains=50"}), 50);
}

}  // namespace
}  // namespace taut::listening_tests
