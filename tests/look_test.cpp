// measure, plot and scan as a user types them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using json = nlohmann::json;

std::string said(const std::string& arguments, int exit_code = 0) {
  const auto outcome = taut(arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << arguments << "\n" << outcome.text;
  return outcome.text;
}

constexpr const char* kShortRun = "run freely_jointed --steps 200 --set build.chains=10 run.log_every=2 ";

// Means over seeds: the mean of the runs' means, with the larger of the two errors.
TEST(Look, MeasuresSeedsTogether) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  for (const char* seed : {"1", "2", "3"})
    said(kShortRun + std::string("run.seed=") + seed + " --quiet --out " + at + seed);
  const std::string runs = at + "1 " + at + "2 " + at + "3 ";
  const json all = json::parse(said("measure " + runs + "--json --from 0.5 --out " + at + "measured"));
  const json& t = all["mean"]["temperature_k"];
  double mean = 0;
  for (const json& run : all["runs"]) {
    EXPECT_NEAR(run["from_ps"], 0.5, 1e-9);
    mean += run["temperature_k"]["value"].get<double>() / 3;
  }
  EXPECT_EQ(all["runs"].size(), 3u);
  EXPECT_NEAR(t["value"], mean, 1e-9);
  EXPECT_EQ(t["error"], std::max(t["error_by_seeds"].get<double>(), t["error_by_blocks"].get<double>()));
  EXPECT_GT(t["error_by_seeds"].get<double>(), 0);
  EXPECT_TRUE(fs::exists(at + "measured/seeds.csv"));
  EXPECT_THAT(said("measure " + runs), HasSubstr("mean of 3 runs"));
  EXPECT_THAT(said("measure " + at + "1 " + at + "1"), HasSubstr("the same seed"));
  said("run pair --steps 5 --quiet --out " + at + "pair");
  EXPECT_THAT(said("measure " + at + "1 " + at + "pair", 2), HasSubstr("runs of one scene"));
}

// A second segment that begins where the first ends is one run with it.
TEST(Look, MeasuresSegmentsAsOneRun) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  said(kShortRun + std::string("run.trajectory_every=2 --quiet --out ") + at + "1");
  said(kShortRun + std::string("run.trajectory_every=2 run.trajectory=h5md build.start=") + at +
       "1/final.start.toml --quiet --out " + at + "2");
  const json one = json::parse(said("measure --json " + at + "1"));
  const json both = json::parse(said("measure --join --json " + at + "1 " + at + "2"));
  EXPECT_EQ(one["rows"], 101);
  EXPECT_EQ(both["rows"], 201);
  EXPECT_EQ(both["frames"], 201);
  EXPECT_EQ(json::parse(said("measure --join --last 1 --json " + at + "1 " + at + "2"))["rows"], 51);
}

TEST(Look, MeasureRefusesWhatItCannotDo) {
  const TemporaryFolder folder;
  const std::string run = (folder.path() / "run").string();
  said(kShortRun + std::string("--quiet --out ") + run);
  EXPECT_THAT(said("measure --from soon " + run, 2), HasSubstr("expected a time in ps, or auto"));
  EXPECT_THAT(said("measure --from 1e3 " + run, 2), HasSubstr("the log ends at 2 ps"));
  EXPECT_THAT(said("measure --from 1 --last 1 " + run, 2), HasSubstr("one of them"));
  EXPECT_THAT(said("measure --from auto " + run), HasSubstr("Chodera"));
  EXPECT_THAT(said("measure --viscosity 1 " + run, 2), HasSubstr("run.trajectory_every"));
}

}  // namespace
}  // namespace taut
