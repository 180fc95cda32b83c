#include "pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "files/atomic_file.hpp"
#include "files/resources.hpp"
#include "printing.hpp"
#include "python.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

// Exit codes: of a Python without matplotlib, and of none.
constexpr int kNoMatplotlib = 4, kNoPython = 127;

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace

std::vector<std::string> files_of_picture(const std::string& name) {
  return {name + ".csv", name + ".pdf", name + ".svg", name + ".png"};
}

void PictureOptions::offer(const Subcommand& command) {
  command.option("--size", size, "width of pictures for print [mm]").one_of("85|170");
  command.option("--format", formats, "of pictures, one or several: pdf,svg,png").one_of("pdf|svg|png");
}

void StudyFiles::write(const std::string& name, const std::string& text) {
  write_file(folder_ / name, text);
  if (std::ranges::find(written_, name) == written_.end()) written_.push_back(name);
}

void StudyFiles::draw(const Picture& p) {
  write(p.name + ".csv", p.csv);
  asked_.push_back(p);
}

void StudyFiles::draw_all(const std::vector<std::string>& for_page) {
  if (asked_.empty()) return;
  json pictures = json::array();
  for (const Picture& p : asked_) {
    json tables = p.beside;
    tables[p.name] = p.csv;
    pictures.push_back({{"name", p.name},
                        {"title", p.title},
                        {"tables", tables},
                        {"svg", std::ranges::count(for_page, p.name) > 0}});
    std::error_code ignored;  // pictures of an earlier run
    for (const std::string& file : files_of_picture(p.name))
      if (!file.ends_with(".csv")) fs::remove(folder_ / file, ignored);
  }
  const json request = {{"folder", fs::absolute(folder_).string()},
                        {"size", options_.size},
                        {"formats", options_.formats},
                        {"pictures", pictures}};
  const std::string input = request.dump(-1, ' ', false, json::error_handler_t::replace);
  const fs::path script = resource_folder("pictures");
  for (const std::string& interpreter : python_interpreters()) {
    const PythonEnd end = run_python(interpreter, script, input);
    if (end.code == kNoMatplotlib || end.code == kNoPython) {
      if (missing_.empty() || end.code == kNoMatplotlib)
        missing_ = end.code == kNoPython
                       ? fmt::format(
                             "pictures need Python with matplotlib (Debian: python3-matplotlib), and {} "
                             "cannot be run: {}",
                             interpreter, last_line(end.error))
                       : fmt::format("{} for {}", last_line(end.error), interpreter);
      continue;
    }
    missing_.clear();
    take(end.code == 0 ? end.output : "");
    if (reason_.empty() && !undrawn_.empty())
      reason_ = end.error.empty() ? fmt::format("{} ended with {}", interpreter, end.code)
                                  : fmt::format("{}: {}", interpreter, last_line(end.error));
    break;
  }
  asked_.clear();
}

void StudyFiles::take(const std::string& drawn) {
  const json all = json::parse(drawn, nullptr, false);
  for (std::size_t n = 0; n < asked_.size(); ++n) {
    const std::string& name = asked_[n].name;
    const json one = all.is_array() && n < all.size() && all[n].is_object() ? all[n] : json::object();
    if (one.contains("failed") && reason_.empty()) reason_ = one["failed"].get<std::string>();
    if (one.contains("refused")) refused_ = one["refused"].get<std::string>();
    if (!one.contains("files")) {
      undrawn_.push_back(name);
      continue;
    }
    if (one["files"].empty()) empty_.push_back(name);
    for (const std::string& file : files_of_picture(name))
      if (std::ranges::count(one["files"], json(file)) > 0) written_.push_back(file);
    svg_[name] = one.value("svg", "");
  }
}

std::string StudyFiles::svg(const std::string& name) const {
  const auto at = svg_.find(name);
  return at == svg_.end() ? "" : at->second;
}

void StudyFiles::print_written() {
  draw_all();
  say("\nwrote into {}: {}\n", folder_.string(), fmt::join(written_, ", "));
  if (!empty_.empty()) say("nothing to draw of {}: no setting got through\n", fmt::join(empty_, ", "));
  if (!missing_.empty())
    say("no pictures: {}; then {} draws them\n", missing_,
        fs::exists(folder_ / "run.csv") ? "the same command with --overwrite"
                                        : fmt::format("`taut plot {}`", quoted_for_shell(folder_.string())));
  if (!refused_.empty()) throw InputError("--" + refused_);
  if (!undrawn_.empty())
    throw OutsideError(fmt::format("cannot draw {}: {}; the figures are in the .csv files",
                                   fmt::join(undrawn_, ", "), reason_));
}

}  // namespace taut
