#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "files/folder.hpp"
#include "report.hpp"
#include "scene_argument.hpp"
#include "studies/ledger.hpp"

namespace taut {

// The rows of a table, each an object with the columns' names.
nlohmann::ordered_json json_of_csv(const std::string& csv);

// Prints the notes of a scene, one line each.
void print_notes(const std::vector<std::string>& notes);

// Throws InputError if one of these files exists, unless `overwrite` is set.
void expect_no_file(const std::vector<std::filesystem::path>& files, bool overwrite);

// Opens and locks the folder of a study. A stopped study with the same command `line` is continued. Throws
// InputError if the folder has another study; `overwrite` moves that to FOLDER.1, or the first free number.
FolderLock study_folder(const std::filesystem::path& folder, const std::string& line, bool overwrite);

constexpr const char* kOverwrite = "move the study that is in --out to OUT.1, OUT.2, ..., and start";

// The arguments that chart and stability share.
struct StudyArguments {
  const char* name;  // of the subcommand, and of its default folder
  SceneArgument scene{};
  std::vector<std::string> methods{};
  bool quick = false, overwrite = false;
  std::filesystem::path out = name;
  PictureOptions pictures{};

  void offer_first(const Subcommand& command);
  void offer_last(const Subcommand& command, const char* quick_means);

  Scene read() const;                               // with the settings of studies
  std::vector<std::string> methods_or_all() const;  // throws for unknown names
  // The command line; `own` adds the subcommand's own options.
  std::string command(const std::function<void(CommandLine&)>& own) const;
};

// A study of many trials that can be stopped and continued.
class Study {
 public:
  // Identifies the study by its command and a hash of the texts of its scenes.
  Study(const StudyArguments& arguments, const std::string& command, const std::vector<Scene>& scenes);

  const Ledger& ledger() const { return ledger_; }
  // Runs the jobs that are not in the ledger yet, and shows the time left on the terminal. SIGINT, SIGTERM
  // and SIGHUP end it at once; finished trials are in the ledger.
  void run(const std::vector<Job>& jobs, const std::vector<std::string>& notes);
  StudyFiles& files() { return files_; }
  // Shows a picture's table in the report: as charts, or as `drawn` for print where it is no curves.
  void show(const Picture& picture, const std::string& heading, const std::string& text, bool drawn = false);
  // Puts what the picture shown last says, a line each, below it in the report.
  void conclude(const std::vector<std::string>& lines);
  void show_table(const std::string& file, const std::string& csv, ReportPage::Part part);
  // Writes report.html and prints its name; with --json prints all tables instead.
  void finish(const std::string& title);

 private:
  nlohmann::ordered_json json() const;

  std::string line_;
  FolderLock lock_;
  Ledger ledger_;
  StudyFiles files_;
  ReportPage page_;
  std::vector<std::pair<std::string, std::string>> tables_;  // name and CSV
};

}  // namespace taut
