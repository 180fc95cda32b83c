#include "systems/lammps/tables.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace taut {

// Columns: a number, the distance or the angle in degrees, E and −dE/dr or −dE/dθ. The second derivative of E is zero
// at both ends (FP). Pairs take no distance of 0.
std::string LammpsTables::add(Of of, const Spline& energy) {
  constexpr std::array kNames = {"BOND", "ANGLE", "PAIR"};
  const auto [at, fresh] =
      known_.try_emplace({of, &energy}, fmt::format("{}{}", kNames[of], known_.size() + 1));
  const std::string named = fmt::format("{} {}", file_name_, at->second);
  if (!fresh) return named;
  constexpr int kBetween = 10;
  const double unit = of == kAngle ? 180 / std::numbers::pi : 1, step = energy.spacing() / kBetween;
  const int all = static_cast<int>(energy.intervals().size()) * kBetween,
            first = of == kPair && energy.first() == 0 ? 1 : 0;
  const int count = all - first + 1;
  const auto place = [&](int k) { return k == all ? energy.last() : energy.first() + k * step; };
  text_ += fmt::format("# {}\n{}\nN {}", energy.name(), at->second, count);
  if (of == kPair)
    text_ += fmt::format(" R {:.17g} {:.17g} FPRIME 0 0\n\n", place(first), place(all));
  else
    text_ += fmt::format(" FP 0 0 EQ {:.17g}\n\n", unit * energy.place_of_least());
  for (int k = first; k <= all; ++k) {
    const auto [value, slope] = energy.at(place(k));
    text_ +=
        fmt::format("{} {:.17g} {:.17g} {:.17g}\n", k - first + 1, unit * place(k), value, -slope / unit);
  }
  text_ += "\n";
  return named;
}

}  // namespace taut
