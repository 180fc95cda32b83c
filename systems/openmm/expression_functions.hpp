#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string>

#include "systems/openmm/expression.hpp"

namespace taut {

// What OpenMM's expressions compute, with what it is uncertain by.
namespace rough {

using Rough = Expression::Rough;
using Arguments = std::span<const Rough>;
constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kTenDigits = 1e-10;
constexpr std::size_t kMostArguments = 6;

// Returns a value with the error of its arguments and of its own rounding.
inline Rough rounded(double value, double error) {
  error += kTenDigits * std::abs(value);
  return {value, std::isnan(error) && !std::isnan(value) ? kUnknown : error};
}

// A smooth function is as uncertain as it changes over what its arguments are uncertain by.
template <class Function>
Rough smooth(const Function& f, Arguments x) {
  std::array<double, kMostArguments> at{};
  for (std::size_t k = 0; k < x.size(); ++k) at[k] = x[k].value;
  const auto value = [&] { return f(std::span<const double>(at.data(), x.size())); };
  const double here = value();
  double error = 0;
  for (std::size_t k = 0; k < x.size(); ++k)
    for (const int to : {-1, 1}) {
      if (x[k].error == 0) continue;
      at[k] = x[k].value + to * x[k].error;
      const double there = value();
      at[k] = x[k].value;
      if (std::isnan(here) && !std::isnan(there))
        return {0, kUnknown};  // at the edge of where it has a value
      error += 0.5 * std::abs(there - here);
    }
  return rounded(here, error);
}

// A function of one formula.
struct Smooth {
  int arguments;
  double (*value)(std::span<const double>);
};
// A function whose formula may be another one from some point on. It says which way it goes.
struct Branching {
  int arguments;
  Rough (*value)(Arguments, int& way);
};
template <class Function>
using Functions = std::map<std::string, Function, std::less<>>;

const Functions<Smooth>& smooth_functions();
const Functions<Branching>& branching_functions();

}  // namespace rough
}  // namespace taut
