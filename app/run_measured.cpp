#include "run_measured.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "printing.hpp"
#include "simulation/checkpoint.hpp"

namespace taut {
namespace {

constexpr std::string_view kByRun = "run,";  // how tables begin in which runs are laid over each other

// What the runs' frames and pressures show, each table once.
std::vector<Picture> tables_of(const std::vector<std::optional<MeasuredRun>>& runs,
                               const std::vector<std::string>& names) {
  const long count = std::ranges::count_if(runs, [](const auto& run) { return run.has_value(); });
  const bool several = count > 1;
  std::vector<Picture> together;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!runs[k]) continue;
    for (Picture& picture : runs[k]->pictures(several ? names[k] : "")) {
      const auto known = std::ranges::find(together, picture.name, &Picture::name);
      if (picture.name == "equilibration" || (several && !picture.csv.starts_with(kByRun))) continue;
      if (several) picture.title = counted(count, "run") + picture.title.substr(runs[k]->scene().name.size());
      if (known == together.end())
        together.push_back(std::move(picture));
      else
        known->csv += picture.csv.substr(picture.csv.find('\n') + 1);
    }
  }
  return together;
}

}  // namespace

void print_run(const MeasuredRun& run) {
  say_text(run.in_words());
  if (json_alone()) return;
  for (const std::string& doubt : run.doubts()) say_always(fmt::format("in doubt: {}\n", doubt));
}

std::vector<std::optional<MeasuredRun>> measure_runs(const std::vector<std::filesystem::path>& runs,
                                                     ReportPage& page, long most_frames) {
  MeasureSettings settings;
  settings.automatic = true;
  settings.most_frames = most_frames;
  std::vector<std::optional<MeasuredRun>> all(runs.size());
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!std::filesystem::exists(checkpoint_file(runs[k]))) continue;
    try {
      all[k].emplace(std::vector{runs[k]}, settings);
    } catch (const InputError& e) {
      page.notes.push_back(fmt::format("not measured: {}", e.what()));
      say("note: {}\n", page.notes.back());
      continue;
    }
    say("\nmeasured: ");
    print_run(*all[k]);
  }
  return all;
}

void add_measured(const std::vector<std::optional<MeasuredRun>>& runs, const std::vector<std::string>& names,
                  Picture& picture, ReportPage& page) {
  std::string csv = kEachRunHeader, numbers, windows;
  long count = 0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!runs[k]) continue;
    ++count;
    numbers += fmt::format("{}{} {}", count > 1 ? ", " : "Runs: ", count, names[k]);
    windows += fmt::format("{}: {}. ", names[k], runs[k]->window());
    if (runs[k]->stride() > 1) windows += fmt::format("Of {} frames one is read. ", runs[k]->stride());
    for (const Figure& figure : runs[k]->figures()) csv += each_run_row(figure, names[k], count);
  }
  if (count == 0) return;
  if (count > 1) picture.beside["each_run"] = csv;
  page.parts.push_back(
      {.title = "Measured",
       .text = (count > 1 ? numbers + ". " : "") + windows +
               "What `taut measure --from auto` gives; its other options choose other parts.",
       .picture = "",
       .csv = csv,
       .open = true});
  for (const Picture& table : tables_of(runs, names)) {
    picture.beside[table.name] = table.csv;
    page.parts.push_back({table.title, "", "", table.csv, {}});
  }
}

}  // namespace taut
