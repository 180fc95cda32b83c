#include "study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

#include "files/set_aside.hpp"
#include "md/errors.hpp"
#include "md/threads.hpp"
#include "progress.hpp"
#include "studies/csv.hpp"
#include "systems/scene_source.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Every finished trial is on disk already: nothing to save, so only words that a handler may speak.
extern "C" void stop(int signal) {
  constexpr char kWords[] = "\nstopped; the same command goes on from here\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kWords, sizeof kWords - 1);
  _exit(128 + signal);
}

// While it lives, whoever asks to stop is told that nothing is lost. What was ignored (nohup) stays so.
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

std::string escaped(const std::string& text) {
  static const std::map<char, const char*> kEntities = {
      {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    const auto entity = kEntities.find(c);
    out += entity != kEntities.end() ? entity->second : std::string(1, c);
  }
  return out;
}

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string table_of(const std::string& csv) {
  std::string text = "<div class=scroll><table>\n", tag = "th";
  for (const auto& row : csv_rows(csv)) {
    text += "<tr>";
    for (const auto& cell : row) text += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
    text += "</tr>\n";
    tag = "td";
  }
  return text + "</table></div>\n";
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string first_line(const fs::path& file) {
  std::string line;
  std::ifstream in(file);
  std::getline(in, line);
  return line;
}

// What a study has left in a folder.
std::vector<std::string> study_files(const fs::path& folder) {
  std::vector<std::string> names = {kLedger, "report.html", "failures.csv", "limits.csv", "crosscheck.json"};
  for (const char* picture :
       {"work", "drift", "order", "length", "precision", "plane", "steps", "crosscheck", "distances"})
    for (const char* kind : {".csv", ".gp", ".svg", ".png", ".gnuplot.log"})
      names.push_back(std::string(picture) + kind);
  return present(folder, names);
}

void refuse_another_study(const fs::path& folder, const std::string& line) {
  const std::vector<std::string> files = study_files(folder);
  const bool unfinished = !files.empty() && files.front() == kLedger;
  if (files.empty() || (unfinished && first_line(folder / kLedger) == line)) return;
  throw InputError(fmt::format(
      "{}: holds {} ({}); --overwrite first moves it aside, to {}.1 or the next number that is free",
      folder.string(), unfinished ? "a study that was stopped, of another command or scene" : "a study",
      unfinished ? first_line(folder / kLedger) : files.front(), folder.string()));
}

// From "<svg" on: what stands before does not belong inside a page.
std::string inline_svg(const fs::path& file) {
  const std::string text = contents(file);
  const auto start = text.find("<svg");
  return start == text.npos ? "<p>(not drawn)</p>" : text.substr(start);
}

}  // namespace

void refuse_without_effect(const char* subcommand, const std::vector<std::string>& overrides) {
  for (const auto& override : overrides) {
    const std::string key = override.substr(0, override.find_first_of(" ="));
    const bool own = key == "method" || key.starts_with("method.");
    if (own || key == "run.log_every" || key.starts_with("run.checkpoint") ||
        key.starts_with("run.trajectory"))
      throw InputError(fmt::format("--set {}: no effect, taut {} {}", override, subcommand,
                                   own ? "chooses methods and their settings itself" : "keeps no such file"));
  }
}

void print_notes(const Scene& scene) {
  for (const auto& note : scene.notes) fmt::print("  note: {}\n", note);
}

std::string study_line(const std::string& command, const std::vector<Scene>& scenes) {
  std::string texts;
  for (const Scene& scene : scenes)
    for (const auto& [name, text] : source_of(scene, false, {}).files) texts += text;
  std::string line = fmt::format("{} # {:016x}", command, std::hash<std::string>{}(texts));
  std::ranges::replace(line, '\n', ' ');
  return line;
}

FolderLock study_folder(const fs::path& folder, const std::string& line, bool overwrite) {
  if (!overwrite) refuse_another_study(folder, line);
  FolderLock lock(folder);
  if (!overwrite) refuse_another_study(folder, line);  // another process may have been faster
  if (const auto files = study_files(folder); overwrite && !files.empty())
    fmt::print("{}: what was there is kept in {}\n", folder.string(), set_aside(folder, files).string());
  return lock;
}

void run_jobs(const std::vector<Job>& jobs, Ledger& ledger) {
  const StoppedAtOnce stopped_at_once;
  long left = 0, done = 0;
  for (const Job& job : jobs) left += !ledger.has(job.name);
  if (left < static_cast<long>(jobs.size()))
    fmt::print("going on: {} of {} trials are there\n", static_cast<long>(jobs.size()) - left, jobs.size());
  std::fflush(stdout);  // a signal would not
  Progress progress(left);
  for (const Job& job : jobs) {
    if (ledger.has(job.name)) continue;
    ledger.once(job.name, job.make);
    progress.at(++done);
  }
  progress.clear();
}

void write_report(const ReportPage& page, StudyFiles& files) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><title>{0}</title>\n"
      "<style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}}"
      "svg{{max-width:100%;height:auto}}table{{border-collapse:collapse;font-size:12px}}"
      "td,th{{padding:1px 8px;border-bottom:1px solid #ddd;text-align:left}}"
      ".scroll{{max-height:24em;overflow:auto}}code{{background:#f3f3f3;padding:2px 4px}}</style>\n"
      "<h1>{0}</h1>\n<p>Made by <code>{1}</code></p>\n"
      "<p>Processor {2}, {3} threads. Compiler {4}, flags <code>{5}</code>.</p>\n",
      escaped(page.title), escaped(page.command), escaped(processor()), available_threads(), TAUT_COMPILER,
      TAUT_FLAGS);
  for (const auto& part : page.parts) {
    html += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", escaped(part.title), escaped(part.text));
    if (!part.svg_file.empty()) html += inline_svg(files.folder() / part.svg_file) + "\n";
    html += fmt::format("<details><summary>The figures</summary>\n{}</details>\n", table_of(part.csv));
  }
  files.write("report.html", html + "</html>\n");
}

}  // namespace taut
