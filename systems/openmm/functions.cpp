#include "systems/openmm/functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace taut {
namespace {

std::vector<double> read_values(const Element& function) {
  std::vector<double> values;
  function.check_parts({"Values"});
  function.part("Values").each("Value", [&](const Element& value) {
    value.read_leaf({{"v", &values.emplace_back()}});
  });
  return values;
}

Expression::Table read_discrete(const Element& function, bool plane) {
  std::string name, type;
  int x = 0, y = 1;
  const auto size = [](const char* of, int& to) { return Field{of, Field::Integer{&to, 1, 10'000}}; };
  std::vector<Field> fields = {{"name", &name}, {"type", &type}};
  if (plane) fields.insert(fields.end(), {size("xsize", x), size("ysize", y)});
  function.read(fields, {"version"});
  const std::vector<double> values = read_values(function);
  if (!plane) x = static_cast<int>(values.size());
  if (values.size() != static_cast<std::size_t>(x) * y)
    function.refuse(fmt::format("has {} values, expected {} x {}", values.size(), x, y));
  return {plane ? 2 : 1, [=](std::span<const double> at) {
            const double i = std::round(at[0]), j = plane ? std::round(at[1]) : 0;
            if (!(i >= 0 && i < x && j >= 0 && j < y)) return std::nan("");
            return values[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * x];
          }};
}

std::shared_ptr<const Spline> read_continuous(const Element& function) {
  std::string name, type;
  double min = 0, max = 0;
  bool periodic = false;
  std::vector<Field> fields = {{"name", &name}, {"type", &type}, {"min", &min}, {"max", &max}};
  if (function.has_attribute("periodic")) fields.push_back({"periodic", &periodic});  // from version 2 on
  function.read(fields, {"version"});
  if (periodic) function.refuse(fmt::format("has the periodic function {}: taut's tables are not", name));
  std::vector<double> values = read_values(function);
  try {
    return std::make_shared<const Spline>(name, min, max, std::move(values));
  } catch (const InputError& e) {
    function.refuse(e.what());
  }
}

// By the point of the largest value, and then between all points.
std::shared_ptr<const Spline> multiple_of(const std::shared_ptr<const Spline>& spline,
                                          const std::function<double(double)>& energy) {
  const std::vector<double>& values = spline->values();
  const auto largest = std::ranges::max_element(values, {}, [](double v) { return std::abs(v); });
  const auto point = [&](double place) { return spline->first() + place * spline->spacing(); };
  const double factor =
      *largest == 0 ? 1 : energy(point(static_cast<double>(largest - values.begin()))) / *largest;
  if (!std::isfinite(factor) || (factor == 0 && *largest != 0)) return nullptr;
  for (std::size_t k = 0; k + 1 < values.size(); ++k)
    for (const double t : {0.01, 0.37, 0.81}) {
      const double r = point(static_cast<double>(k) + t);
      if (!(std::abs(energy(r) - factor * spline->at(r).value) <= 1e-9 * std::abs(factor * *largest)))
        return nullptr;
    }
  if (std::abs(factor - 1) < 1e-12) return spline;  // but for rounding
  std::vector<double> scaled = values;
  for (double& v : scaled) v *= factor;
  return std::make_shared<const Spline>(spline->name(), spline->first(), spline->last(), std::move(scaled));
}

}  // namespace

std::shared_ptr<const Spline> recognize_spline(const Splines& splines,
                                               const std::function<double(double)>& energy) {
  const auto ends_with = [&](const Spline& one) {  // also where the others go on
    for (const auto& [name, other] : splines)
      for (int k = 0; k < std::ssize(other->values()); ++k)
        if (const double at = other->first() + k * other->spacing(); !one.covers(at) && energy(at) != 0)
          return false;
    return true;
  };
  for (const auto& [name, spline] : splines)
    if (auto found = multiple_of(spline, energy); found && ends_with(*found)) return found;
  return nullptr;
}

Expression::Rough rough_value(const Spline& spline, double at) {
  for (const double end : {spline.first(), spline.last()})
    if (std::abs(at - end) < 1e-9 * spline.last()) return {0, std::numeric_limits<double>::infinity()};
  if (!spline.covers(at)) return {};
  const double largest = std::ranges::max(spline.values(), {}, [](double v) { return std::abs(v); });
  return {spline.at(at).value, 1e-9 * std::abs(largest)};
}

Expression::Tables read_functions(const Element& force, Splines& splines) {
  Expression::Tables tables;
  force.part("Functions").each("Function", [&](const Element& function) {
    const std::string type = function.text("type"), name = function.text("name");
    if (type == "Continuous1DFunction") {
      const auto spline = splines[name] = read_continuous(function);
      tables[name] = {1, [spline](std::span<const double> at) {
                        return spline->covers(at[0]) ? spline->at(at[0]).value : 0;
                      }};
    } else if (type == "Discrete1DFunction" || type == "Discrete2DFunction") {
      tables[name] = read_discrete(function, type == "Discrete2DFunction");
    } else {
      function.refuse(
          fmt::format("has the function {} of a kind ({}) taut does not know: it has Continuous1DFunction, "
                      "Discrete1DFunction and Discrete2DFunction",
                      name, type));
    }
  });
  return tables;
}

}  // namespace taut
