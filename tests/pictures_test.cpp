// The pictures of studies: drawn by Python, whatever names are in them and whatever Python does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "measures/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::pictures_tests {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

// A scene of some name: what is in it is text to the shell, to a table, to a page and in a picture.
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
                                           "<script>x<&amp;%s%n@x{:b $^2_$}#\\", "1,2;\"3\"\"\",\u00b5"));

TEST_P(HostileNames, AreTextEverywhere) {
  const TemporaryFolder folder;
  const std::string scene = scene_named(folder.path(), GetParam()), at = " --out " + folder.path().string();
  for (const auto& [command, out, picture] :
       {std::tuple{"chart " + scene + " --quick --methods newton none --drift-steps 100", "/chart", "work"},
        {"stability " + scene + " --quick --steps 20 --methods shake", "/stability", "steps"}}) {
    const fs::path files = folder.path().string() + out;
    const std::string text = said(command + " --format svg" + at + out);
    EXPECT_TRUE(fs::exists(files / (std::string(picture) + ".svg"))) << text;
    EXPECT_FALSE(fs::exists(files / "x") || fs::exists(files / "y")) << "a command was run";
    EXPECT_FALSE(fs::exists("x") || fs::exists("y")) << "a command was run";
    if (std::string_view(GetParam()).find("%s%n") != std::string_view::npos) {
      EXPECT_THAT(contents(files / (std::string(picture) + ".svg")), HasSubstr("%s%n@x{:b $^2_$}#"));
    }
    const std::string report = contents(files / "report.html");
    EXPECT_EQ(report.find("<script"), report.rfind("<script")) << "a script beside the page's own";
    EXPECT_FALSE(fs::exists(files / "unfinished.tsv"));
  }
  const auto rows = csv_rows(contents(folder.path() / "stability" / "steps.csv"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].size(), rows[0].size());
  std::string name = GetParam();
  for (char& c : name) c = c == '"' ? '\'' : c < ' ' && c > 0 ? ' ' : c;
  EXPECT_EQ(rows[1][0], name);
}

// Width and height of a PNG [pixels].
std::pair<int, int> pixels(const fs::path& file) {
  const std::string bytes = contents(file);
  const auto number = [&](std::size_t at) {
    int n = 0;
    for (std::size_t k = at; k < at + 4; ++k) n = n * 256 + static_cast<unsigned char>(bytes[k]);
    return n;
  };
  return bytes.size() < 24 ? std::pair{0, 0} : std::pair{number(16), number(20)};
}

// A study leaves a table and a picture, which are drawn again from the folder alone, as wide as a journal's column or page
// and in its forms.
TEST(Pictures, AreForPrintAndAreDrawnAgainFromTheirTables) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string(), again = (folder.path() / "again").string();
  said("chart water_cluster --quick --methods newton rattle --drift-steps 200 --out " + out);
  EXPECT_EQ(pixels(out + "/work.png").first, 2007) << "170 mm of 300 dots an inch";
  EXPECT_FALSE(fs::exists(out + "/work.svg"));
  EXPECT_THAT(contents(out + "/report.html"),
              AllOf(HasSubstr(">rattle (tolerance)<"), Not(HasSubstr("<svg"))))
      << "curves are drawn by the page itself";
  said("plot " + out + " --size 85 --format pdf,svg png --out " + again);
  EXPECT_EQ(pixels(again + "/work.png").first, 1003);
  EXPECT_THAT(contents(again + "/work.pdf"), ContainsRegex("MediaBox \\[ 0 0 240\\.94"));
  for (const char* name : {"work", "drift", "order", "length", "precision"}) {
    EXPECT_EQ(contents(again + "/" + name + ".csv"), contents(out + "/" + name + ".csv"));
    const std::string svg = contents(again + "/" + name + ".svg");
    EXPECT_THAT(svg, AllOf(HasSubstr("width=\"240.94"), HasSubstr(">newton"), HasSubstr(">rattle"))) << name;
    EXPECT_THAT(svg, Not(ContainsRegex("font: [0-6](\\.[0-9]+)?px"))) << "letters are of 7 points or more";
  }
  EXPECT_THAT(said("plot " + out + " --format jpg", 2), HasSubstr("expected pdf|svg|png, got jpg"));
  EXPECT_THAT(said("plot " + out + " --size 100", 2), HasSubstr("expected 85|170, got 100"));
  for (const std::string option : {"--frames 5", "--panels frame"})
    EXPECT_THAT(said("plot " + out + " " + option, 2), HasSubstr("needs runs; these are tables")) << option;
}

// Where no setting gets through there is nothing to draw, which is no failure.
TEST(Pictures, SayWhereThereIsNothingToDraw) {
  const TemporaryFolder folder;
  const std::string text =
      said("chart diatomic --quick --methods newton --dt-fs 1e4 --drift-steps 100 --out " +
           (folder.path() / "out").string());
  EXPECT_THAT(text, HasSubstr("nothing to draw of work, drift, order"));
}

// Nothing is left in a home that matplotlib has no cache in, and one that takes no file is not spoken of.
TEST(Pictures, LeaveTheHomeAlone) {
  const TemporaryFolder folder;
  const fs::path home = folder.path() / "home";
  for (const auto& [mode, out] : {std::pair{fs::perms::owner_all, "/a"}, {fs::perms::none, "/b"}}) {
    fs::create_directory(home);
    fs::permissions(home, mode);
    const auto [exit_code, text] = taut(
        "chart diatomic --quick --methods newton --drift-steps 100 --out " + folder.path().string() + out,
        "HOME=" + home.string() + " XDG_CACHE_HOME= XDG_CONFIG_HOME=");
    EXPECT_EQ(exit_code, 0) << text;
    EXPECT_THAT(text, AllOf(HasSubstr("work.png"), Not(HasSubstr("atplotlib"))));
    fs::permissions(home, fs::perms::owner_all);
    EXPECT_TRUE(fs::is_empty(home));
  }
}

// Whatever Python does, only what is there is said to be written.
struct Python {
  const char *name, *script;  // empty: there is none
  int exit_code;
  const char* says;
};
class Pythons : public ::testing::TestWithParam<Python> {};
INSTANTIATE_TEST_SUITE_P(
    That, Pythons,
    ::testing::Values(
        Python{"IsNotThere", "", 0, "python3-matplotlib), and "},
        Python{"HasNoMatplotlib",
               "exec /usr/bin/env python3 -c 'import sys; sys.modules[\"matplotlib\"] = "
               "None; sys.argv = sys.argv[2:]; import runpy; "
               "runpy.run_path(sys.argv[0], run_name=\"__main__\")' \"$@\"",
               0,
               "no pictures: pictures need matplotlib: pip install matplotlib (Debian: python3-matplotlib)"},
        Python{"Fails", "echo so; echo no >&2; exit 1", 3, "cannot draw work, drift, order, length: "},
        Python{"IsKilled", "kill -9 $$", 3, "python ended with 137"},
        Python{"DrawsNothing", "exit 0", 3, "python ended with 0"},
        Python{"SaysNonsense", "echo [1]", 3, "cannot draw work, drift"}),
    [](const auto& test) { return test.param.name; });

TEST_P(Pythons, AreNotTakenAtTheirWord) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "chart", python = folder.path() / "python";
  if (*GetParam().script) {
    std::ofstream(python) << "#!/bin/sh\n" << GetParam().script << "\n";
    fs::permissions(python, fs::perms::owner_all);
  }
  const auto [exit_code, text] =
      taut("chart diatomic --quick --methods newton --drift-steps 100 --out " + out.string(),
           "TAUT_PYTHON=" + python.string());
  EXPECT_EQ(exit_code, GetParam().exit_code) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().says));
  const std::string line = text.substr(text.find("wrote into"),
                                       text.find('\n', text.find("wrote into")) - text.find("wrote into"));
  for (const char* name : {"work", "drift", "order", "length"})
    for (const char* kind : {".csv", ".pdf", ".svg", ".png"}) {
      const std::string file = std::string(name) + kind;
      EXPECT_EQ(fs::exists(out / file), line.find(file) != line.npos) << file << ": " << line;
    }
  EXPECT_THAT(line, HasSubstr("report.html"));
  EXPECT_THAT(contents(out / "report.html"), HasSubstr("newton"));
}

}  // namespace
}  // namespace taut::pictures_tests
