#include "measures/zero_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/words.hpp"
#include "measures/csv.hpp"

namespace taut {
namespace {

constexpr const char* kStep = "run.dt_fs";

// The points of each figure that all groups have.
ZeroSteps fitted(const std::vector<const RunGroup*>& groups, const std::vector<double>& lengths) {
  ZeroSteps all;
  for (const OverSeeds& first : groups.front()->figures) {
    std::vector<AtStep> points;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const OverSeeds& o : groups[g]->figures)
        if (o.figure.key == first.figure.key) points.push_back({lengths[g], o.figure.value});
    if (points.size() < groups.size()) continue;
    const std::optional<ZeroStep> fit = at_zero_step(points);
    if (!fit) continue;
    all.figures.push_back({first.figure, *fit});
    all.figures.back().figure.value = fit->value;
  }
  return all;
}

}  // namespace

std::string ZeroSteps::label() const {
  const std::string others = in_words(values);
  return others.empty() ? "at zero step" : others + " at zero step";
}

std::vector<ZeroSteps> at_zero_step(const std::vector<RunGroup>& groups) {
  struct Curve {
    ScanValues others;
    std::vector<const RunGroup*> groups;
    std::vector<double> lengths;
    std::string steps;
  };
  std::vector<Curve> curves;
  for (const RunGroup& group : groups) {
    const auto step = std::ranges::find(group.values, kStep, [](const auto& v) { return v.first; });
    if (step == group.values.end()) return {};
    auto others = group.values;
    others.erase(others.begin() + (step - group.values.begin()));
    auto at = std::ranges::find(curves, others, &Curve::others);
    if (at == curves.end()) at = curves.insert(curves.end(), Curve{others, {}, {}, {}});
    at->groups.push_back(&group);
    at->lengths.push_back(number_in(step->second).value_or(0));
    at->steps += (at->steps.empty() ? "" : ", ") + step->second;
  }
  std::vector<ZeroSteps> all;
  for (const Curve& curve : curves) {
    ZeroSteps of = fitted(curve.groups, curve.lengths);
    if (of.figures.empty()) continue;
    of.values = curve.others;
    of.steps = curve.steps;
    all.push_back(std::move(of));
  }
  return all;
}

std::string in_words(const ZeroSteps& of, int width) {
  std::vector<std::vector<std::string>> rows = {{"", "", "", "χ²", "of", "on the line"}};
  for (const auto& [figure, fit] : of.figures)
    rows.push_back({"  " + figure.words, with_error(figure.value), figure.unit,
                    fit.free > 0 ? fmt::format("{:.2g}", fit.chi_square) : "", fmt::format("{}", fit.free),
                    fit.free == 0 ? "two steps cannot tell"
                    : fit.on_the_line()
                        ? "yes"
                        : fmt::format("no ({:.1g}): leave the longest step out", fit.chance)});
  return fmt::format("{}: the line in h² through {} = {}; means lie on it while h⁴ is small\n", of.label(),
                     kStep, of.steps) +
         table_text(rows, width);
}

nlohmann::ordered_json json_of(const ZeroSteps& of) {
  nlohmann::ordered_json json = {{"label", of.label()}};
  json["values"][kStep] = "0";
  for (const auto& [key, value] : of.values) json["values"][key] = value;
  for (const auto& [figure, fit] : of.figures)
    json["mean"][figure.key] = {{"value", fit.value.value},
                                {"error", fit.value.error},
                                {"slope_per_fs2", fit.slope.value},
                                {"slope_error", fit.slope.error},
                                {"chi_square", fit.chi_square},
                                {"degrees_of_freedom", fit.free},
                                {"chance", fit.chance}};
  return json;
}

std::string zero_steps_csv(const std::vector<ZeroSteps>& all) {
  std::string csv =
      "figure,unit,curve,value,standard_error,slope_per_fs2,slope_error,chi_square,degrees_of_freedom,"
      "chance\n";
  for (const ZeroSteps& of : all)
    for (const auto& [figure, fit] : of.figures)
      csv +=
          fmt::format("{},{},{},{:.9g},{:.3g},{:.6g},{:.3g},{:.4g},{},{:.3g}\n", csv_cell(figure.words),
                      csv_cell(figure.unit), csv_cell(in_words(of.values)), fit.value.value, fit.value.error,
                      fit.slope.value, fit.slope.error, fit.chi_square, fit.free, fit.chance);
  return csv;
}

}  // namespace taut
