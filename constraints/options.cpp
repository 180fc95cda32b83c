#include "constraints/options.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"

namespace taut {
namespace {

std::optional<double> number_of(const Option& option) {
  if (auto* const* real = std::get_if<double*>(&option.field)) return **real;
  if (auto* const* count = std::get_if<int*>(&option.field)) return **count;
  if (auto* const* either = std::get_if<std::optional<double>*>(&option.field)) return **either;
  return {};
}

}  // namespace

std::string Option::value() const {
  if (auto* const* flag = std::get_if<bool*>(&field)) return **flag ? "true" : "false";
  if (auto* const* text = std::get_if<std::string*>(&field)) return fmt::format("\"{}\"", **text);
  const auto given = number_of(*this);
  return given ? fmt::format("{:g}", *given) : "not set";
}

std::string Option::allowed() const {
  return taut::allowed(about.range, about.words);
}

std::string Option::in_words() const {
  const std::string unit = *about.unit ? fmt::format(" [{}]", about.unit) : "";
  const std::string is = allowed();
  return fmt::format("{} = {}: {}{}{}", key, value(), meaning, unit, is.empty() ? "" : " (" + is + ")");
}

void check_options(const std::vector<Option>& options) {
  for (const Option& option : options) {
    const auto given = number_of(option);
    const auto& [unit, range, counts, words] = option.about;
    if (!words.empty())
      expect_name(fmt::format("method.{}", option.key), **std::get_if<std::string*>(&option.field), words);
    if (given && counts.read && !range.holds(*given))
      throw InputError(fmt::format("method.{}: expected {}, got {}", option.key, range.in_words(), *given));
  }
}

}  // namespace taut
