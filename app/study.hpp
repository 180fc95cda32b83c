#pragma once

#include <string>
#include <vector>

#include "files/folder_lock.hpp"
#include "pictures.hpp"
#include "studies/ledger.hpp"

namespace taut {

// Throws InputError for a key among `overrides` that a study sets itself: it would have no effect.
void refuse_without_effect(const char* subcommand, const std::vector<std::string>& overrides);

// What was changed in a scene or is worth knowing of its start, a line each.
void print_notes(const Scene& scene);

// What a study is kept as: its command, and a number for the texts its scenes were read from. Where either is
// another, so is the study.
std::string study_line(const std::string& command, const std::vector<Scene>& scenes);

// The folder of a study, this process's alone. Where there is one that was stopped, and `line` is its own, it
// goes on. Throws InputError where there is another one, finished or not: `overwrite` moves that to FOLDER.1,
// or the first number that is free.
FolderLock study_folder(const std::filesystem::path& folder, const std::string& line, bool overwrite);

constexpr const char* kOverwrite = "move the study that is in --out to OUT.1, OUT.2, ..., and start";
constexpr const char* kLedger = "unfinished.tsv";  // there until a study is finished

// Runs what the ledger has not yet, with the time left on the terminal. SIGINT, SIGTERM and SIGHUP end it at
// once, with what is finished in the ledger.
void run_jobs(const std::vector<Job>& jobs, Ledger& ledger);

// A page that needs nothing else: pictures (as SVG, inside it), tables, how it was made and on what.
struct ReportPage {
  std::string title, command;
  struct Part {
    std::string title, text;  // text: plain, in sentences
    std::string svg_file;     // in the same folder; none: empty
    std::string csv;          // shown as a table
  };
  std::vector<Part> parts;
};
void write_report(const ReportPage& page, StudyFiles& files);  // report.html

}  // namespace taut
