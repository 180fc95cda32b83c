#include "studies/chart_verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/words.hpp"

namespace taut {
namespace {

struct Limit {
  double error;
  const char* text;
};
constexpr Limit kLimits[] = {{1e-4, "1e-4"}, {1e-6, "1e-6"}, {1e-9, "1e-9"}};
constexpr Limit kGood = kLimits[1];  // of what is recommended

// The cheapest of those that fit, and those of other methods that the quartiles do not tell from it.
std::string cheapest(const std::vector<ChartPoint>& points, const auto& fits) {
  std::vector<std::string> names, methods;
  double high = 0;
  for (const ChartPoint& p : points) {
    if (!fits(p) || std::ranges::count(methods, p.method) > 0) continue;
    if (!names.empty() && p.cost.low > high) continue;
    if (names.empty()) high = p.cost.high;
    names.push_back(fmt::format("{}, {:.3g} ns a bond", p.name, p.cost.median));
    methods.push_back(p.method);
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, " or "));
}

}  // namespace

std::vector<std::string> chart_verdict(std::vector<ChartPoint> points, double dt_fs) {
  std::ranges::stable_sort(points, {}, [](const ChartPoint& p) { return p.cost.median; });
  std::string below;
  for (const Limit& limit : kLimits)
    below += fmt::format("{}{}: {}", below.empty() ? "" : "; ", limit.text,
                         cheapest(points, [&](const ChartPoint& p) { return p.error < limit.error; }));
  below = "cheapest with rms error below " + below;
  std::vector<std::string> keep, methods;
  bool judged = false;
  for (const ChartPoint& p : points) {
    judged = judged || p.keeps_energy;
    if (!p.keeps_energy.value_or(false) || std::ranges::count(methods, p.method) > 0) continue;
    keep.push_back(p.name);
    methods.push_back(p.method);
  }
  if (!judged)
    return {
        fmt::format("which to take at {:g} fs is not known: the runs are too short for an error of the drift",
                    dt_fs),
        below};
  const auto does_both = [](const ChartPoint& p) {
    return p.keeps_energy.value_or(false) && p.error < kGood.error;
  };
  const auto best = std::ranges::find_if(points, does_both);
  return {
      best == points.end()
          ? fmt::format(
                "take a shorter step: at {:g} fs nothing keeps the energy with an rms bond error below {}",
                dt_fs, kGood.text)
          : fmt::format(
                "take {}: the cheapest at {:g} fs with an rms bond error below {} whose energy drift is "
                "zero within ±{:.1g} kJ/mol/ns per degree of freedom",
                cheapest(points, does_both), dt_fs, kGood.text, best->width),
      below,
      fmt::format("keeps energy within error at {:g} fs, the cheapest setting of each method: {}", dt_fs,
                  keep.empty() ? "none" : fmt::format("{}", fmt::join(keep, ", ")))};
}

std::string warn_of_load(double load, long cores) {
  if (static_cast<double>(cores) - load >= 0.5) return "";
  return fmt::format(
      "the machine is busy (load {:.1f} of {} in the last minute): the times are noise; chart again when it "
      "is idle",
      load, counted(cores, "core"));
}

}  // namespace taut
