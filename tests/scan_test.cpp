// scan as a user types it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/zero_step.hpp"
#include "measures/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::scan_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using json = nlohmann::json;

// A scan whose runs are partly gone takes those alone again; the others stay as they are.
TEST(Scan, GoesOnWhereItStopped) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "scan").string();
  const std::string command =
      "scan freely_jointed --steps 100 --set build.chains=5 run.log_every=5 --vary run.temperature_k=200,400 "
      "--vary method.name=newton,rattle --seeds 2 --out " +
      out;
  EXPECT_THAT(said(command), AllOf(HasSubstr("8 runs of 4 settings"), HasSubstr("8 of 8")));
  const auto rows = csv_rows(contents(out + "/runs.csv"));
  ASSERT_EQ(rows.size(), 9u);
  EXPECT_EQ(rows[3], (std::vector<std::string>{"003", "1", "200", "rattle"}));
  const auto kept = fs::last_write_time(out + "/002/summary.json");
  fs::remove_all(out + "/001");
  const json again = json::parse(said(command + " --json"));
  EXPECT_EQ(fs::last_write_time(out + "/002/summary.json"), kept);
  ASSERT_EQ(again.size(), 4u);
  EXPECT_EQ(again[1]["values"]["method.name"], "rattle");
  EXPECT_EQ(again[1]["mean"]["temperature_k"]["runs"], 2);
  EXPECT_EQ(json::parse(said("measure --from auto --json " + out)), again);
  EXPECT_TRUE(fs::exists(out + "/scan.png"));
  said("plot " + out);
  const std::string words = (folder.path() / "words").string();  // along x stand words
  said("scan pair --steps 5 --vary method.name=newton,rattle --out " + words);
  EXPECT_TRUE(fs::exists(words + "/scan.png"));
  EXPECT_THAT(said(command + " --dt-fs 1", 2), HasSubstr("another scan"));
}

// Over steps every figure is taken to none, for each setting of the other keys, on the terminal, in JSON and as a table.
TEST(Scan, OfStepsIsExtrapolatedToNone) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "scan").string();
  const std::string command =
      "scan freely_jointed --steps 200 --set build.chains=5 run.log_every=2 run.thermostat_ps=0.1 "
      "--vary method.name=newton,rattle --vary run.dt_fs=2,4,5 --seeds 2 --out " +
      out;
  EXPECT_THAT(said(command),
              AllOf(HasSubstr("method.name=rattle at zero step: the line in h² through run.dt_fs = 2, 4, 5"),
                    HasSubstr("on the line")));
  const json all = json::parse(said("measure --from auto --json " + out));
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all[6]["values"]["method.name"], "newton");
  EXPECT_EQ(all[6]["values"]["run.dt_fs"], "0");
  EXPECT_EQ(all[6]["mean"]["temperature_k"]["degrees_of_freedom"], 1);
  std::vector<AtStep> points;
  for (int k = 0; k < 3; ++k) {
    const json& t = all[k]["mean"]["temperature_k"];
    points.push_back({std::vector<double>{2, 4, 5}[k], {t["value"], t["error"]}});
  }
  EXPECT_NEAR(all[6]["mean"]["temperature_k"]["value"].get<double>(), at_zero_step(points)->value.value,
              1e-6);
  EXPECT_THAT(contents(out + "/zero_step.csv"), HasSubstr("\ntemperature,K,method.name=newton,"));
  said(command + " --quiet");  // its table is its own
}

// What a person keeps in the folder is never written over.
TEST(Scan, LeavesForeignFilesAlone) {
  const TemporaryFolder folder;
  const std::string command = "scan pair --steps 5 --vary run.dt_fs=1,2 --out " + folder.path().string();
  for (const char* name : {"runs.csv", "002.log", "scan.png"}) {
    folder.write(name, "mine");
    EXPECT_THAT(said(command, 2), AllOf(HasSubstr(name), HasSubstr("take another folder")));
    EXPECT_EQ(contents((folder.path() / name).string()), "mine");
    fs::remove(folder.path() / name);
  }
  folder.write("notes.txt", "mine");
  said(command + " --quiet");
  said(command + " --quiet");  // its own files are
}

// As many runs at once as this process may use cores.
TEST(Scan, TakesTheCoresItMayUse) {
  const TemporaryFolder folder;
  const Outcome outcome =
      taut("scan pair --steps 5 --vary run.dt_fs=1,2 --out " + folder.path().string(),
           "core=$(taskset -pc $$ | sed 's/.*: //; s/[-,].*//') && OMP_NUM_THREADS=1 taskset -c $core");
  EXPECT_THAT(outcome.text, HasSubstr("2 runs of 2 settings, 1 at once"));
}

TEST(Scan, RefusesWhatItCannotRun) {
  const TemporaryFolder folder;
  const std::string out = " --out " + (folder.path() / "scan").string();
  EXPECT_THAT(said("scan pair" + out, 2), HasSubstr("nothing to scan"));
  EXPECT_THAT(said("scan pair --vary run.dt_fs=" + out, 2), HasSubstr("VALUE,VALUE"));
  EXPECT_THAT(said("scan pair --vary run.dt_fs=1,-1" + out, 2), HasSubstr("dt_fs"));
  EXPECT_THAT(said("scan pair --vary run.seed=1,2" + out, 2), HasSubstr("--seeds"));
  EXPECT_FALSE(fs::exists(folder.path() / "scan"));
  EXPECT_THAT(said("scan pair --steps 5 --seeds 2" + out, 2),
              AllOf(HasSubstr("every run of the scan failed"), HasSubstr("run.seed: has no effect")));
}

}  // namespace
}  // namespace taut::scan_tests
