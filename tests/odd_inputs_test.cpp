// What users type and files they have that are unusual, but right; and what is told to those where it is not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::odd_inputs_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(OddInputs, NumbersOfStepsAreWrittenAsInScenes) {
  for (const char* steps : {"1e1", "10.0"})
    EXPECT_THAT(taut(std::string("run pair --steps ") + steps).text, HasSubstr("  10 steps of 1 fs"))
        << steps;
}

// A name of bytes that are no UTF-8 is a name; JSON has U+FFFD in its place.
TEST(OddInputs, AFileNameNeedNotBeUtf8) {
  const TemporaryFolder folder;
  const fs::path scene = folder.path() / "p\xe4r.toml", out = folder.path() / "out";
  fs::copy(TAUT_SCENES "/pair.toml", scene);
  said("run '" + scene.string() + "' --steps 10 --out " + out.string());
  EXPECT_EQ(nlohmann::json::parse(contents(out / "summary.json"))["scene"], "p\xef\xbf\xbdr");
  said("resume " + out.string() + " --steps 10");
  const std::string json = said("run '" + scene.string() + "' --steps 10 --json");
  EXPECT_TRUE(nlohmann::json::accept(json)) << json;
}

// What is promised is what is done, with a slash at the end and through a link.
TEST(OddInputs, AFolderIsMovedWhereItIsSaid) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", link = folder.path() / "link";
  const std::string run = "run pair --steps 10 --out ";
  ASSERT_EQ(taut(run + out.string()).exit_code, 0);
  fs::create_directory_symlink(out, link);
  for (const fs::path& given : {out / "", out / ".", link}) {
    const std::string refused = said(run + given.string(), 2);
    EXPECT_THAT(refused, HasSubstr("moves it aside, to " + out.string() + ".1 or the next")) << given;
  }
  EXPECT_THAT(taut(run + out.string() + "/ --overwrite").text,
              HasSubstr("is kept in " + out.string() + ".1\n"));
  EXPECT_TRUE(fs::exists(out.string() + ".1/log.csv"));
}

TEST(OddInputs, AnEmptyNameIsNoFolder) {
  for (const char* command : {"run pair --steps 5 --out ''", "chart pair --quick --out ''", "resume ''"}) {
    const auto refused = taut(command);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_THAT(refused.text, HasSubstr("expected a path, got an empty one")) << command;
  }
}

TEST(OddInputs, SaysWhatANumberMayBe) {
  const auto refused = [](const std::string& settings) {
    return said("run water --steps 0 --set " + settings, 2);
  };
  EXPECT_EQ(
      refused("run.seed=18446744073709551615"),
      "taut: --set run.seed=18446744073709551615: run.seed: out of range, expected a whole number of at most "
      "9223372036854775807\n");
  EXPECT_EQ(refused("forcefield.coulomb=pme forcefield.pme_grid=[4000,4000,4000]"),
            "taut: --set forcefield.pme_grid=[4000,4000,4000]: forcefield.pme_grid: pme: a grid of 4000 x "
            "4000 x 4000 "
            "points, expected at most 268435456 in all\n");
  EXPECT_THAT(refused("forcefield.coulomb=pme forcefield.pme_order=9"),
              HasSubstr("--set forcefield.pme_order=9: forcefield.pme_order: pme: order 9, expected 4 to 8"));
  EXPECT_THAT(refused("forcefield.coulomb=pme forcefield.ewald_tolerance=1e-40"),
              HasSubstr("ewald_tolerance: pme: "));
}

// A key of the file that an override leaves without effect is set aside, one that is typed beside it is
// refused.
TEST(OddInputs, KeysOfPairForcesSayWhereTheyCount) {
  const std::string wca = said("run chain --steps 0 --set forcefield.pair=wca");
  EXPECT_THAT(wca, HasSubstr("note: forcefield.cutoff_nm is set aside: pairs of wca end at 2^(1/6) sigma"));
  const std::string typed = said("run chain --steps 0 --set forcefield.pair=wca forcefield.cutoff_nm=1", 2);
  EXPECT_THAT(typed, HasSubstr("forcefield.cutoff_nm: has no effect, it counts only with forcefield.pair = "
                               "\"lennard-jones\" or charges: pairs of wca end at 2^(1/6) sigma"));
  EXPECT_THAT(taut("run freely_jointed --set forcefield.cutoff_nm=1").text,
              HasSubstr("it counts only with pair forces: no atom has a charge or an epsilon_kj_mol here"));
}

TEST(OddInputs, NumbersAreEchoedAsTheyWereTyped) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(taut("run pair --steps 10 --out " + out.string()).exit_code, 0);
  EXPECT_THAT(
      taut("resume " + out.string() + " --set run.minimise_force_kj_mol_nm=0.8").text,
      HasSubstr("--set run.minimise_force_kj_mol_nm=0.8: run.minimise_force_kj_mol_nm cannot change"));
}

// A scene's files are read again for what is kept of a run, which a pipe does not give; OpenMM's are read once.
TEST(OddInputs, APipeIsNoSceneButASystem) {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(taut("run " + pipe).text, HasSubstr("pipe: a pipe or a device, which can be read once only"));
  const std::string data = TAUT_TEST_DATA "/tip3p-216";
  std::thread writer([&] { std::ofstream(pipe) << std::ifstream(data + ".system.xml").rdbuf(); });
  const auto kept = taut("run --openmm " + pipe + " " + data + ".state.xml --steps 1 --out " +
                         (folder.path() / "out").string());
  writer.join();
  EXPECT_EQ(kept.exit_code, 0) << kept.text;
  EXPECT_EQ(taut("resume " + (folder.path() / "out").string() + " --steps 1").exit_code, 0);
}

TEST(OddInputs, AFileThatCannotBeMadeIsCalledByItsName) {
  const std::string refused = said("crosscheck pair --export /nowhere/at/all", 3);
  EXPECT_THAT(refused, HasSubstr("taut: /nowhere/at/all.system.xml: cannot open: No such file"));
  EXPECT_THAT(refused, Not(HasSubstr(".part")));
}

}  // namespace
}  // namespace taut::odd_inputs_tests
