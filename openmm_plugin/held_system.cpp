#include "openmm_plugin/held_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"

namespace taut {
namespace {

template <class Number>
Number number(const std::string& key, const std::string& word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    throw InputError(fmt::format("{}: expected {}, got \"{}\"", key,
                                 std::is_integral_v<Number> ? "a whole number" : "a number", word));
  return value;
}

void set(const Option& option, const std::string& word) {
  const std::string key = option.key;
  if (auto* const* real = std::get_if<double*>(&option.field)) **real = number<double>(key, word);
  if (auto* const* count = std::get_if<int*>(&option.field)) **count = number<int>(key, word);
  if (auto* const* either = std::get_if<std::optional<double>*>(&option.field))
    **either = number<double>(key, word);
  if (auto* const* text = std::get_if<std::string*>(&option.field)) **text = word;
  if (auto* const* flag = std::get_if<bool*>(&option.field)) {
    if (word != "true" && word != "false")
      throw InputError(fmt::format("{}: expected true or false, got \"{}\"", key, word));
    **flag = word == "true";
  }
}

}  // namespace

MethodOptions method_of(const HoldSettings& settings) {
  MethodOptions method = default_options(settings.method);
  if (method.name() == "penalty")
    throw InputError(
        "method \"penalty\" puts springs in place of bonds: give OpenMM a HarmonicBondForce, or take "
        "\"newton\"");
  const std::vector<Option> options = method.describe();
  for (const auto& [key, word] : settings.options) {
    const std::string_view name = key;
    const auto found = std::ranges::find(options, name, [](const Option& option) { return option.key; });
    if (found == options.end()) {
      std::vector<std::string_view> names;
      for (const Option& option : options) names.push_back(option.key);
      throw InputError(fmt::format("method \"{}\" has no option \"{}\"{}", method.name(), name,
                                   did_you_mean(name, names)));
    }
    set(*found, word);
  }
  check_options(method.describe());
  return method;
}

System system_of(const HeldBonds& held) {
  std::vector<RigidBond> bonds;
  for (const auto& [i, j, length] : held.bonds)
    if (held.masses[i] > 0 || held.masses[j] > 0) bonds.push_back({i, j, length});
  return make_system(Eigen::Map<const Eigen::VectorXd>(held.masses.data(), std::ssize(held.masses)), bonds);
}

}  // namespace taut
