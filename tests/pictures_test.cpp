// The pictures of studies: drawn by gnuplot, whatever names are in them and whatever gnuplot does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::pictures_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A scene of some name: what is in it is text to the shell, to gnuplot, to a table and to a page.
std::string scene_named(const fs::path& folder, const std::string& name) {
  const fs::path file = folder / (name + ".toml");
  fs::copy_file(fs::path(TAUT_SCENES) / "diatomic.toml", file);
  std::string quoted = "'";
  for (const char c : file.string()) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

class HostileNames : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, HostileNames,
                         ::testing::Values("a`touch x`'\"\\n$(touch y)", "a\nb\tc'.system(\"touch x\").'",
                                           "<script>x<&amp;%s%n@x{:b ^2}#\\", "1,2;\"3\"\"\",\u00b5"));

TEST_P(HostileNames, AreTextEverywhere) {
  const TemporaryFolder folder;
  const std::string scene = scene_named(folder.path(), GetParam()), at = " --out " + folder.path().string();
  for (const auto& [command, out, picture] :
       {std::tuple{"chart " + scene + " --quick --methods newton none --drift-steps 100", "/chart", "work"},
        {"stability " + scene + " --quick --steps 20 --methods shake", "/stability", "steps"}}) {
    const fs::path files = folder.path().string() + out;
    const auto [exit_code, text] = taut(command + at + out);
    EXPECT_EQ(exit_code, 0) << text;
    EXPECT_TRUE(fs::exists(files / (std::string(picture) + ".png"))) << text;
    EXPECT_FALSE(fs::exists(files / "x") || fs::exists(files / "y")) << "a command was run";
    EXPECT_FALSE(fs::exists("x") || fs::exists("y")) << "a command was run";
    if (std::string_view(GetParam()).find("%s%n") != std::string_view::npos) {
      EXPECT_THAT(contents(files / (std::string(picture) + ".svg")), HasSubstr("%s%n@x{:b ^2}#"));
    }
    EXPECT_THAT(contents(files / "report.html"), Not(HasSubstr("<script")));
    EXPECT_FALSE(fs::exists(files / "unfinished.tsv"));
  }
  const auto rows = csv_rows(contents(folder.path() / "stability" / "steps.csv"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].size(), rows[0].size());
  std::string name = GetParam();
  for (char& c : name) c = c == '"' ? '\'' : c < ' ' && c > 0 ? ' ' : c;
  EXPECT_EQ(rows[1][0], name);
}

// The script draws the picture again where the folder has been moved to, whatever else is on that machine.
TEST(Pictures, AreDrawnAgainFromTheFolderAlone) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", moved = folder.path() / "moved";
  ASSERT_EQ(
      taut("chart water_cluster --quick --methods newton rattle --drift-steps 200 --out " + out.string())
          .exit_code,
      0);
  fs::create_directory(moved);
  for (const auto& file : fs::directory_iterator(out))
    if (const auto kind = file.path().extension(); kind != ".svg" && kind != ".png")
      fs::copy(file.path(), moved / file.path().filename());
  for (const char* name : {"work", "drift", "order", "length", "precision"}) {
    const std::string picture = name;
    const std::string command = "cd " + moved.string() + " && gnuplot " + picture + ".gp";
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(contents(moved / (picture + ".svg")), contents(out / (picture + ".svg"))) << name;
    EXPECT_THAT(contents(moved / (picture + ".svg")), HasSubstr(">newton")) << "named in the key";
    EXPECT_THAT(contents(moved / (picture + ".svg")), HasSubstr(">rattle"));
  }
  EXPECT_THAT(contents(moved / "work.svg"), HasSubstr("water_cluster: constraints at"));
}

// Where no setting gets through there is nothing to draw, which is no failure of gnuplot.
TEST(Pictures, SayWhereThereIsNothingToDraw) {
  const TemporaryFolder folder;
  const auto [exit_code, text] =
      taut("chart diatomic --quick --methods newton --dt-fs 1e4 --drift-steps 100 --out " +
           (folder.path() / "out").string());
  EXPECT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr("nothing to draw of work, drift, order"));
  EXPECT_FALSE(fs::exists(folder.path() / "out" / "work.gnuplot.log"));
}

// Whatever gnuplot does, only what is there is said to be written.
struct Gnuplot {
  const char *name, *script;  // empty: there is none
  int exit_code;
  const char* says;
};
class Gnuplots : public ::testing::TestWithParam<Gnuplot> {};
INSTANTIATE_TEST_SUITE_P(
    That, Gnuplots,
    ::testing::Values(Gnuplot{"IsNotThere", "", 0, "gnuplot is not installed"},
                      Gnuplot{"Fails", "echo no >&2; exit 1", 3, "work.gnuplot.log"},
                      Gnuplot{"DrawsNothing", "exit 0", 3, "gnuplot could not draw work, drift"},
                      Gnuplot{"DrawsHalf", ": > ${1%.gp}.svg", 3, "gnuplot could not draw work, drift"}),
    [](const auto& test) { return test.param.name; });

TEST_P(Gnuplots, AreNotTakenAtTheirWord) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "chart", bin = folder.path() / "bin";
  fs::create_directory(bin);
  if (*GetParam().script) {
    std::ofstream(bin / "gnuplot") << "#!/bin/sh\n" << GetParam().script << "\n";
    fs::permissions(bin / "gnuplot", fs::perms::owner_all);
  }
  const auto [exit_code, text] =
      taut("chart diatomic --quick --methods newton --drift-steps 100 --out " + out.string(),
           "PATH=" + bin.string());
  EXPECT_EQ(exit_code, GetParam().exit_code) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().says));
  const std::string line = text.substr(text.find("wrote into"),
                                       text.find('\n', text.find("wrote into")) - text.find("wrote into"));
  for (const char* name : {"work", "drift", "order", "length"})
    for (const char* kind : {".csv", ".gp", ".svg", ".png"}) {
      const std::string file = std::string(name) + kind;
      EXPECT_EQ(fs::exists(out / file), line.find(file) != line.npos) << file << ": " << line;
    }
  EXPECT_THAT(line, HasSubstr("report.html"));
  EXPECT_THAT(contents(out / "report.html"), HasSubstr("newton"));
}

}  // namespace
}  // namespace taut::pictures_tests
