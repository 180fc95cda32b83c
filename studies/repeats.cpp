#include "studies/repeats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

Quartiles quartiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], place - static_cast<double>(below));
  };
  return {at(0.25), at(0.5), at(0.75)};
}

std::string repeat_name(const std::string& point, int repeat) {
  return fmt::format("{} #{}", point, repeat);
}

std::vector<Job> interleaved(const std::vector<Job>& points, int repeats, const Ledger& ledger) {
  std::vector<Job> jobs;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (const Job& point : points)
      jobs.push_back({repeat_name(point.name, repeat), [&ledger, point, repeat] {
                        const std::string first = repeat_name(point.name, 0);
                        if (repeat > 0 && ledger.at(first).failed()) return ledger.at(first);
                        return point.make();
                      }});
  return jobs;
}

Quartiles over_repeats(const std::string& point, int repeats, const Ledger& ledger, double Trial::*figure) {
  std::vector<double> values;
  values.reserve(repeats);
  for (int repeat = 0; repeat < repeats; ++repeat)
    if (const Trial& trial = ledger.at(repeat_name(point, repeat)); !trial.failed())
      values.push_back(trial.*figure);
  return quartiles(std::move(values));
}

}  // namespace taut
