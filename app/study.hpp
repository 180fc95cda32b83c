#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "files/folder_lock.hpp"
#include "report.hpp"
#include "scene_argument.hpp"
#include "studies/ledger.hpp"

namespace taut {

// What was changed in a scene or is worth knowing of its start, a line each.
void print_notes(const std::vector<std::string>& notes);

// Throws InputError where one of these files is there, but for `overwrite`.
void expect_no_file(const std::vector<std::filesystem::path>& files, bool overwrite);

// The folder of a study, this process's alone. Where there is one that was stopped, and `line` is its own, it
// goes on. Throws InputError where there is another one, finished or not: `overwrite` moves that to FOLDER.1,
// or the first number that is free.
FolderLock study_folder(const std::filesystem::path& folder, const std::string& line, bool overwrite);

constexpr const char* kOverwrite = "move the study that is in --out to OUT.1, OUT.2, ..., and start";

// What chart and stability are both asked.
struct StudyArguments {
  const char* name;  // the subcommand's, and its folder's if not said
  SceneArgument scene{};
  std::vector<std::string> methods{};
  bool quick = false, overwrite = false;
  std::filesystem::path out = name;

  void offer_first(const Subcommand& command);
  void offer_last(const Subcommand& command, const char* quick_means);

  Scene read() const;                               // as studies run it
  std::vector<std::string> methods_or_all() const;  // refuses unknown names before anything runs
  // As typed; `own` adds what the subcommand has besides.
  std::string command(const std::function<void(CommandLine&)>& own) const;
};

// A study of many trials that can be stopped, from its folder to its report.
class Study {
 public:
  // What it is kept as: its command, and a number for the texts its scenes were read from. Where either is
  // another, so is the study.
  Study(const StudyArguments& arguments, const std::string& command, const std::vector<Scene>& scenes);

  const Ledger& ledger() const { return ledger_; }
  // Runs what the ledger has not yet, with the time left on the terminal. SIGINT, SIGTERM and SIGHUP end it
  // at once, with what is finished in the ledger.
  void run(const std::vector<Job>& jobs, const std::vector<std::string>& notes);
  StudyFiles& files() { return files_; }
  void show(const Picture& picture, const std::string& heading, const std::string& text);
  void show_table(const std::string& file, const std::string& csv, ReportPage::Part part);
  // Writes report.html, and tells of it; as JSON, all tables in place of what else is printed.
  void finish(const std::string& title);

 private:
  std::string json() const;

  std::string line_;
  FolderLock lock_;
  Ledger ledger_;
  StudyFiles files_;
  ReportPage page_;
  std::vector<std::pair<std::string, std::string>> tables_;  // by name, as CSV
};

}  // namespace taut
