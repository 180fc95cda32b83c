#include "forcefield/spline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/errors.hpp"

namespace taut {
namespace {

// The slopes s of the natural spline through y, in units of the spacing:
//     2s₀ + s₁ = 3(y₁ − y₀),   s_{i−1} + 4s_i + s_{i+1} = 3(y_{i+1} − y_{i−1}),   s_{n−1} + 2s_n = 3(y_n − y_{n−1}),
// by elimination from the first row to the last.
std::vector<double> natural_slopes(const std::vector<double>& y) {
  const std::size_t n = y.size();
  std::vector<double> above(n), s(n);  // what is left above the diagonal, and the right-hand side
  above[0] = 0.5;
  s[0] = 1.5 * (y[1] - y[0]);
  for (std::size_t i = 1; i < n; ++i) {
    const bool end = i == n - 1;
    const double pivot = 1 / ((end ? 2 : 4) - above[i - 1]);
    above[i] = pivot;
    s[i] = pivot * (3 * (y[end ? i : i + 1] - y[i - 1]) - s[i - 1]);
  }
  for (std::size_t i = n - 1; i-- > 0;) s[i] -= above[i] * s[i + 1];
  return s;
}

}  // namespace

Spline::Spline(std::string name, double first, double last, std::vector<double> values)
    : name_(std::move(name)), first_(first), last_(last), values_(std::move(values)) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("the table {} {}", name_, what));
  };
  if (values_.size() < 3) refuse(fmt::format("has {} values, expected 3 or more", values_.size()));
  if (!(last_ > first_) || !std::isfinite(last_ - first_))
    refuse(fmt::format("goes from {:g} to {:g}", first_, last_));
  if (!std::ranges::all_of(values_, [](double v) { return std::isfinite(v); }))
    refuse("has a value that is not a finite number");
  spacing_ = (last_ - first_) / static_cast<double>(values_.size() - 1);
  const std::vector<double> s = natural_slopes(values_);
  for (std::size_t i = 0; i + 1 < values_.size(); ++i) {
    const double rise = values_[i + 1] - values_[i];
    intervals_.push_back({values_[i], s[i], 3 * rise - 2 * s[i] - s[i + 1], s[i] + s[i + 1] - 2 * rise});
  }
}

Spline::Value Spline::at(double x) const {
  const double place = (x - first_) / spacing_;
  const auto last_interval = static_cast<double>(intervals_.size() - 1);
  const double interval = std::clamp(std::floor(place), 0.0, last_interval), t = place - interval;
  const auto& [a, b, c, d] = intervals_[static_cast<std::size_t>(interval)];
  return {a + t * (b + t * (c + t * d)), (b + t * (2 * c + t * 3 * d)) / spacing_};
}

double Spline::place_of_least() const {
  return first_ + spacing_ * static_cast<double>(std::ranges::min_element(values_) - values_.begin());
}

}  // namespace taut
