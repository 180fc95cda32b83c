#include "run_measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "measured_run.hpp"
#include "printing.hpp"
#include "simulation/checkpoint.hpp"
#include "studies/csv.hpp"
#include "words.hpp"

namespace taut {
namespace {

struct NamedRun {
  std::string name;
  MeasuredRun run;
};

constexpr std::string_view kByRun = "run,";  // how tables begin in which runs are laid over each other

// The pictures of one run; of several those that show them together.
std::vector<Picture> pictures_of(const std::vector<NamedRun>& all) {
  if (all.size() == 1) return all[0].run.pictures();
  std::vector<Picture> together;
  for (const NamedRun& one : all)
    for (Picture& picture : one.run.pictures(one.name)) {
      if (!picture.csv.starts_with(kByRun)) continue;
      const auto known = std::ranges::find(together, picture.name, &Picture::name);
      if (known != together.end()) {
        known->csv += picture.csv.substr(picture.csv.find('\n') + 1);
        continue;
      }
      picture.title = counted(std::ssize(all), "run") + picture.title.substr(one.run.scene().name.size());
      together.push_back(std::move(picture));
    }
  return together;
}

// figure, unit, run and its number, value, error.
std::string table_of(const std::vector<NamedRun>& all) {
  std::string csv = "figure,unit,run,number,value,standard_error\n";
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const Figure& figure : all[k].run.figures())
      csv += fmt::format("{},{},{},{},{:.9g},{:.3g}\n", label_cell(figure.words), label_cell(figure.unit),
                         label_cell(all[k].name), k + 1, figure.value.value, figure.value.error);
  return csv;
}

std::string numbers_of(const std::vector<NamedRun>& all) {
  if (all.size() == 1) return "";
  std::string text = "Runs: ";
  for (std::size_t k = 0; k < all.size(); ++k)
    text += fmt::format("{}{} {}", k > 0 ? ", " : "", k + 1, all[k].name);
  return text + ". ";
}

}  // namespace

nlohmann::ordered_json show_measured(const std::vector<std::filesystem::path>& runs,
                                     const std::vector<std::string>& names, StudyFiles& files,
                                     ReportPage& page, long most_frames) {
  MeasureSettings settings;
  settings.automatic = true;
  settings.most_frames = most_frames;
  std::vector<NamedRun> all;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!std::filesystem::exists(checkpoint_file(runs[k]))) continue;
    try {
      all.push_back({names[k], MeasuredRun({runs[k]}, settings)});
    } catch (const InputError& e) {
      page.notes.push_back(fmt::format("not measured: {}", e.what()));
      say("note: {}\n", page.notes.back());
    }
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  if (all.empty()) return json;
  std::string windows;
  for (const NamedRun& one : all) {
    say("\nmeasured: ");
    one.run.print();
    windows += fmt::format("{}: {}. ", one.name, one.run.window());
    if (one.run.stride() > 1) windows += fmt::format("Of {} frames one is read. ", one.run.stride());
    json.push_back(one.run.json());
  }
  const std::string table = table_of(all);
  if (all.size() > 1)
    files.draw({"each_run", counted(std::ssize(all), "run") + ", measured; bars: standard errors", table});
  page.parts.push_back(
      {.title = "Measured",
       .text = numbers_of(all) + windows +
               "What `taut measure --from auto` gives; its other options choose other parts.",
       .svg_file = all.size() > 1 ? "each_run.svg" : "",
       .csv = table,
       .open = true});
  for (const Picture& picture : pictures_of(all)) {
    files.draw(picture);
    page.parts.push_back({picture.title, "", picture.name + ".svg", picture.csv, {}});
  }
  return json;
}

}  // namespace taut
