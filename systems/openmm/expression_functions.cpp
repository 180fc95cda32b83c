#include "systems/openmm/expression_functions.hpp"

#include <algorithm>

namespace taut::rough {
namespace {

using Numbers = std::span<const double>;

constexpr double kFar =
    999'999'999;  // where branches are no longer told apart; Expression::kUndecided is beyond

bool positive(Rough x, int& way) {
  const bool decided = x.error == 0 || std::abs(x.value) > x.error;
  way = decided ? x.value >= 0 : Expression::kUndecided;
  return x.value >= 0;
}

Rough jumps(double value, int way) {
  return {value, way == Expression::kUndecided ? kUnknown : 0};
}

template <double (*kRounding)(double)>
Rough rounding(Arguments a, int& way) {
  const double low = kRounding(a[0].value - a[0].error), high = kRounding(a[0].value + a[0].error);
  way = low == high ? static_cast<int>(std::clamp(low, -kFar, kFar)) : Expression::kUndecided;
  return jumps(kRounding(a[0].value), way);
}

// A function that is next to constant on one side or both: `middle` says whether a value is none of the constants.
template <double (*kFunction)(double), bool (*kMiddle)(double)>
Rough levelling(Arguments a, int& way) {
  const Rough y = smooth([](std::span<const double> x) { return kFunction(x[0]); }, a);
  way = kMiddle(y.value);
  return y;
}
bool above_nothing(double y) {
  return y > 1e-3;
}
bool within_one(double y) {
  return std::abs(y) < 0.999;
}
bool within_two(double y) {
  return above_nothing(y) && y < 1.999;
}

// The distance between nearest images, in a cube of edge 1. Expressions are only compared with each other, and a
// cube of this edge tells a periodic from a plain distance.
Rough periodic_distance(Arguments a, int& way) {
  way = 0;
  double square = 0, error = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double d = a[c].value - a[c + 3].value, e = a[c].error + a[c + 3].error + kTenDigits * std::abs(d);
    const double image = std::round(d);
    if (std::round(d - e) != image || std::round(d + e) != image) {
      way = Expression::kUndecided;
      return jumps(0, way);
    }
    way = static_cast<int>(std::clamp(101.0 * way + image, -kFar, kFar));
    square += (d - image) * (d - image);
    error += e;
  }
  return rounded(std::sqrt(square), error);
}

Rough absolute(Arguments a, int& way) {
  positive(a[0], way);
  return {std::abs(a[0].value), a[0].error};
}

Rough step(Arguments a, int& way) {
  const bool on = positive(a[0], way);
  return jumps(on, way);
}

Rough delta(Arguments a, int& way) {
  positive(a[0], way);
  return jumps(a[0].value == 0, way);
}

Rough select(Arguments a, int& way) {
  positive({-std::abs(a[0].value), a[0].error}, way);  // 0 or not
  const Rough taken = a[a[0].value != 0 ? 1 : 2];
  return way == Expression::kUndecided ? jumps(taken.value, way) : taken;
}

Rough lesser(Arguments a, int& way) {
  positive({a[1].value - a[0].value, a[0].error + a[1].error}, way);
  return {std::min(a[0].value, a[1].value), std::max(a[0].error, a[1].error)};
}

Rough greater(Arguments a, int& way) {
  positive({a[0].value - a[1].value, a[0].error + a[1].error}, way);
  return {std::max(a[0].value, a[1].value), std::max(a[0].error, a[1].error)};
}

}  // namespace

const Functions<Smooth>& smooth_functions() {
  static const Functions<Smooth> kAll = {{"sqrt", {1, [](Numbers a) { return std::sqrt(a[0]); }}},
                                         {"log", {1, [](Numbers a) { return std::log(a[0]); }}},
                                         {"sin", {1, [](Numbers a) { return std::sin(a[0]); }}},
                                         {"cos", {1, [](Numbers a) { return std::cos(a[0]); }}},
                                         {"tan", {1, [](Numbers a) { return std::tan(a[0]); }}},
                                         {"asin", {1, [](Numbers a) { return std::asin(a[0]); }}},
                                         {"acos", {1, [](Numbers a) { return std::acos(a[0]); }}},
                                         {"atan", {1, [](Numbers a) { return std::atan(a[0]); }}},
                                         {"sinh", {1, [](Numbers a) { return std::sinh(a[0]); }}},
                                         {"cosh", {1, [](Numbers a) { return std::cosh(a[0]); }}},
                                         {"square", {1, [](Numbers a) { return a[0] * a[0]; }}},
                                         {"cube", {1, [](Numbers a) { return a[0] * a[0] * a[0]; }}},
                                         {"recip", {1, [](Numbers a) { return 1 / a[0]; }}},
                                         {"atan2", {2, [](Numbers a) { return std::atan2(a[0], a[1]); }}}};
  return kAll;
}

// With the number of their arguments. Where a function levels off to a constant counts as another branch.
const Functions<Branching>& branching_functions() {
  static const Functions<Branching> kAll = {{"abs", {1, absolute}},
                                            {"step", {1, step}},
                                            {"delta", {1, delta}},
                                            {"select", {3, select}},
                                            {"min", {2, lesser}},
                                            {"max", {2, greater}},
                                            {"floor", {1, rounding<std::floor>}},
                                            {"ceil", {1, rounding<std::ceil>}},
                                            {"exp", {1, levelling<std::exp, above_nothing>}},
                                            {"tanh", {1, levelling<std::tanh, within_one>}},
                                            {"erf", {1, levelling<std::erf, within_one>}},
                                            {"erfc", {1, levelling<std::erfc, within_two>}},
                                            {"periodicdistance", {6, periodic_distance}}};
  return kAll;
}

}  // namespace taut::rough
