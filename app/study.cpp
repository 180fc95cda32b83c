#include "study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "files/folder.hpp"
#include "measures/csv.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "studies/study_scene.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/scene_source.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLedger = "unfinished.tsv";  // exists until the study is finished

// Every finished trial is on disk already, so that a handler has nothing to save and only prints.
extern "C" void stop(int signal) {
  constexpr char kWords[] = "\nstopped; the same command goes on from here\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kWords, sizeof kWords - 1);
  _exit(128 + signal);
}

// While this object exists, a signal ends the study after a message that nothing is lost. Ignored signals
// (nohup) stay ignored.
class StoppedAtOnce {
 public:
  StoppedAtOnce() {
    for (std::size_t n = 0; n < kSignals.size(); ++n) {
      before_[n] = std::signal(kSignals[n], stop);
      if (before_[n] == SIG_IGN) std::signal(kSignals[n], SIG_IGN);
    }
  }
  StoppedAtOnce(const StoppedAtOnce&) = delete;
  StoppedAtOnce& operator=(const StoppedAtOnce&) = delete;
  ~StoppedAtOnce() {
    for (std::size_t n = 0; n < kSignals.size(); ++n) std::signal(kSignals[n], before_[n]);
  }

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
  std::array<void (*)(int), kSignals.size()> before_;
};

nlohmann::ordered_json number_or_text(const std::string& cell) {
  if (cell.empty()) return {};
  const auto number = number_in(cell);
  return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json(cell);
}

std::string first_line(const fs::path& file) {
  std::string line;
  std::ifstream in(file);
  std::getline(in, line);
  return line;
}

// The files of a study in a folder.
std::vector<std::string> study_files(const fs::path& folder) {
  std::vector<std::string> names = {kLedger, "report.html", "failures.csv", "limits.csv", "crosscheck.json"};
  for (const char* picture :
       {"work", "drift", "order", "length", "precision", "plane", "steps", "crosscheck", "distances"})
    std::ranges::copy(files_of_picture(picture), std::back_inserter(names));
  return list_present(folder, names);
}

void refuse_another_study(const fs::path& folder, const std::string& line) {
  const std::vector<std::string> files = study_files(folder);
  const bool unfinished = !files.empty() && files.front() == kLedger;
  if (files.empty() || (unfinished && first_line(folder / kLedger) == line)) return;
  throw InputError(fmt::format(
      "{}: holds {} ({}); --overwrite first moves it aside, to {}.1 or the next number that is free",
      folder.string(), unfinished ? "a study that was stopped, of another command or scene" : "a study",
      unfinished ? first_line(folder / kLedger) : files.front(), backup_base(folder).string()));
}

std::string study_line(const std::string& command, const std::vector<Scene>& scenes) {
  std::string texts;
  for (const Scene& scene : scenes)
    for (const auto& [name, text] : source_of(scene, {}).files) texts += text;
  std::string line = fmt::format("{} # {:016x}", command, std::hash<std::string>{}(texts));
  std::ranges::replace(line, '\n', ' ');
  return line;
}

}  // namespace

nlohmann::ordered_json json_of_csv(const std::string& csv) {
  auto table = nlohmann::ordered_json::array();
  const auto rows = csv_rows(csv);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    auto& row = table.emplace_back();
    for (std::size_t c = 0; c < std::min(rows[k].size(), rows[0].size()); ++c)
      row[rows[0][c]] = number_or_text(rows[k][c]);
  }
  return table;
}

void print_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) say("  note: {}\n", note);
}

void expect_no_file(const std::vector<fs::path>& files, bool overwrite) {
  for (const fs::path& file : files)
    if (!overwrite && fs::exists(file))
      throw InputError(fmt::format("{}: is there already; --overwrite replaces it", file.string()));
}

FolderLock study_folder(const fs::path& folder, const std::string& line, bool overwrite) {
  if (!overwrite) refuse_another_study(folder, line);
  FolderLock lock(folder);
  if (!overwrite) refuse_another_study(folder, line);  // another process may have begun a study meanwhile
  if (const auto files = study_files(folder); overwrite && !files.empty())
    say("{}: what was there is kept in {}\n", folder.string(), move_to_backup(folder, files).string());
  return lock;
}

void StudyArguments::offer_first(const Subcommand& command) {
  scene.NamedScene::offer(command);
  command.option("--methods", methods, "which, with settings as in rattle:sweeps=4 (all of `taut methods`)")
      .words(0, "METHOD");
  scene.offer_settings(command);
}

void StudyArguments::offer_last(const Subcommand& command, const char* quick_means) {
  command.flag("--quick", quick, quick_means);
  command.option("--out", out, "folder of the pictures and report.html");
  pictures.offer(command);
  command.flag("--overwrite", overwrite, kOverwrite);
  command.json("print all figures, as JSON");
}

Scene StudyArguments::read() const {
  refuse_without_effect(name, scene.overrides());
  return prepared_for_study(scene.read());
}

std::vector<std::string> StudyArguments::methods_or_all() const {
  if (const auto all = method_names(); methods.empty()) return {all.begin(), all.end()};
  for (const auto& method : methods) method_in_word(method);
  return methods;
}

std::string StudyArguments::command(const std::function<void(CommandLine&)>& own) const {
  CommandLine line = scene.line(name);
  line.option("--methods", methods);
  line.option("--dt-fs", scene.dt_fs);
  line.option("--set", scene.settings);
  own(line);
  line.flag("--quick", quick);
  line.option("--out", {out.string()});
  return line.text();
}

Study::Study(const StudyArguments& arguments, const std::string& command, const std::vector<Scene>& scenes)
    : line_(study_line(command, scenes)),
      lock_(study_folder(arguments.out, line_, arguments.overwrite)),
      ledger_(arguments.out / kLedger, line_),
      files_(arguments.out, arguments.pictures),
      page_{.title = {}, .command = command, .notes = {}, .parts = {}} {}

void Study::run(const std::vector<Job>& jobs, const std::vector<std::string>& notes) {
  const StoppedAtOnce stopped_at_once;
  print_notes(notes);
  page_.notes = notes;
  long left = 0, done = 0;
  for (const Job& job : jobs) left += !ledger_.has(job.name);
  if (left < static_cast<long>(jobs.size()))
    say("going on: {} of {} trials are there\n", static_cast<long>(jobs.size()) - left, jobs.size());
  Progress progress(left);
  progress.write_rows("trials");
  for (const Job& job : jobs) {
    if (ledger_.has(job.name)) continue;
    ledger_.once(job.name, job.make);
    progress.show_step(++done);
  }
  progress.clear();
}

void Study::show(const Picture& picture, const std::string& heading, const std::string& text, bool drawn) {
  files_.draw(picture);
  tables_.emplace_back(picture.name, picture.csv);
  page_.parts.push_back({heading, text, drawn ? picture.name : "", picture.csv, {}});
}

void Study::conclude(const std::vector<std::string>& lines) {
  page_.parts.back().conclusions = lines;
}

void Study::show_table(const std::string& file, const std::string& csv, ReportPage::Part part) {
  files_.write(file, csv);
  tables_.emplace_back(fs::path(file).stem().string(), csv);
  part.csv = csv;
  page_.parts.push_back(std::move(part));
}

void Study::finish(const std::string& title) {
  page_.title = title;
  write_report(page_, files_);
  ledger_.close();
  files_.print_written();
  if (json_alone()) write_json(json());
}

// Converts a table to JSON, each row an object with the columns' names.
nlohmann::ordered_json Study::json() const {
  nlohmann::ordered_json all = {{"command", page_.command}, {"notes", page_.notes}};
  for (const ReportPage::Part& part : page_.parts)
    if (!part.conclusions.empty()) all["conclusions"] = part.conclusions;
  for (const auto& [name, csv] : tables_) all[name] = json_of_csv(csv);
  return all;
}

}  // namespace taut
