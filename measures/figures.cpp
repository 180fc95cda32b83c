#include "measures/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/series.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"

namespace taut {

Estimate mean_with_error(const std::vector<double>& y) {
  const Estimate plain = correlated_mean(y);
  return plain.error > 0 ? mean_of_run(y) : plain;
}

std::string with_error(const Estimate& e) {
  if (e.error <= 0 || !std::isfinite(e.error))
    return fmt::format("{:.5g} (too few samples for an error)", e.value);
  const double leading =
      std::floor(std::log10(e.error));  // two digits of the error, the value to the same place
  const int places = static_cast<int>(1 - leading);
  if (std::abs(e.value) >= 1e6 || places > 8) return fmt::format("{:.6g} ± {:.2g}", e.value, e.error);
  return fmt::format("{:.{}f} ± {:.{}f}", e.value, std::max(0, places), e.error, std::max(0, places));
}

std::string figures_table(const std::vector<Figure>& figures) {
  std::size_t width = 0;
  for (const Figure& figure : figures)
    width = std::max(width, static_cast<std::size_t>(width_of(figure.words)));
  std::string text;
  for (const Figure& figure : figures)
    text += fmt::format("  {}{}  {}{}{}\n", figure.words,
                        std::string(width - static_cast<std::size_t>(width_of(figure.words)), ' '),
                        with_error(figure.value), figure.unit.empty() ? "" : " ", figure.unit);
  return text;
}

std::string each_run_row(const Figure& figure, const std::string& run, long number) {
  return fmt::format("{},{},{},{},{:.9g},{:.3g}\n", csv_cell(figure.words), csv_cell(figure.unit),
                     csv_cell(run), number, figure.value.value, figure.value.error);
}

std::vector<OverSeeds> over_seeds(const std::vector<std::vector<Figure>>& runs) {
  std::vector<OverSeeds> all;
  std::vector<std::vector<Estimate>> values;
  for (const auto& run : runs)
    for (const Figure& figure : run) {
      auto at = std::ranges::find(all, figure.key, [](const OverSeeds& o) { return o.figure.key; });
      if (at == all.end()) {
        all.push_back({.figure = figure});
        values.emplace_back();
        at = all.end() - 1;
      }
      values[static_cast<std::size_t>(at - all.begin())].push_back(figure.value);
    }
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<double> means;
    double squares = 0;
    for (const Estimate& e : values[k]) means.push_back(e.value), squares += e.error * e.error;
    const Estimate mean = independent_mean(means);
    all[k].runs = means.size();
    all[k].from_seeds = mean.error;
    all[k].from_blocks = std::sqrt(squares) / static_cast<double>(means.size());
    all[k].figure.value = {mean.value, std::max(mean.error, all[k].from_blocks)};
  }
  return all;
}

}  // namespace taut
