#include "lammps/keywords.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "constraints/methods/baumgarte.hpp"

namespace taut {
namespace {

template <class Number>
bool parse(const std::string& word, Number& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size();
}

template <class Number>
Number number(const std::string& key, const std::string& word, const char* expected) {
  Number value{};
  if (!parse(word, value)) throw InputError(fmt::format("{}: expected {}, got \"{}\"", key, expected, word));
  return value;
}

bool yes(const std::string& key, const std::string& word) {
  if (word != "yes" && word != "no")
    throw InputError(fmt::format("{}: expected yes or no, got \"{}\"", key, word));
  return word == "yes";
}

// A method's key, as LAMMPS users write it: units are LAMMPS's, so that no key names one.
std::string keyword_of(std::string_view key) {
  if (key == "tolerance") return "tol";
  if (key.ends_with("_per_ps")) key.remove_suffix(7);
  return std::string(key);
}

void set(const Option& option, const std::string& key, const std::string& word) {
  if (auto* const* real = std::get_if<double*>(&option.field)) **real = number<double>(key, word, "a number");
  if (auto* const* count = std::get_if<int*>(&option.field))
    **count = number<int>(key, word, "a whole number");
  if (auto* const* either = std::get_if<std::optional<double>*>(&option.field))
    **either = number<double>(key, word, "a number");
  if (auto* const* text = std::get_if<std::string*>(&option.field)) **text = word;
  if (auto* const* flag = std::get_if<bool*>(&option.field)) **flag = yes(key, word);
}

class Reader {
 public:
  Reader(const std::vector<std::string>& words, const TypeCounts& types) : words_(words), types_(types) {}

  Keywords read() {
    if (words_.empty()) throw InputError("expected a method: feedforward, baumgarte or none");
    const std::string& method = words_[at_++];
    expect_name("method", method, {"feedforward", "baumgarte", "none"});
    given_.method = default_options(method);
    options_ = given_.method.describe();
    while (at_ < words_.size()) keyword();
    check_options(options_);
    const auto& [bonds, angles, types, masses] = given_.held;
    if (bonds.empty() && types.empty() && masses.empty())
      throw InputError("no bonds are named: expected b TYPES, t TYPES or m MASSES");
    return std::move(given_);
  }

 private:
  void keyword() {
    const std::string key = words_[at_++];
    if (key == "b") return type_numbers(key, types_.bonds, given_.held.bonds);
    if (key == "a") return type_numbers(key, types_.angles, given_.held.angles);
    if (key == "t") return type_numbers(key, types_.atoms, given_.held.types);
    if (key == "m") return masses();
    if (at_ == words_.size()) throw InputError(fmt::format("{}: expected a value", key));
    const std::string& value = words_[at_++];
    if (key == "every") return whole(key, value, given_.every);
    if (key == "overlap") return whole(key, value, given_.overlap);
    if (key == "exchanges")
      return value == "auto" ? void(given_.exchanges = -1) : whole(key, value, given_.exchanges);
    if (key == "fixed") return void(given_.fixed_group = value);
    if (key == "clear") return void(given_.clear = yes(key, value));
    if (key == "store") return void(given_.store = yes(key, value));
    if (key == "kbond") {
      given_.restraint = number<double>(key, value, "a number");
      if (!(given_.restraint > 0))
        throw InputError(fmt::format("kbond: expected more than 0, got {}", value));
      return;
    }
    for (const Option& option : options_)
      if (keyword_of(option.key) == key) return set(option, key, value);
    unknown(key);
  }

  void whole(const std::string& key, const std::string& word, int& value) {
    value = number<int>(key, word, "a whole number");
    if (value < 0) throw InputError(fmt::format("{}: expected 0 or more, got {}", key, word));
  }

  // As many as follow: 3, 2*5, *, 4*.
  void type_numbers(const std::string& key, int count, std::set<int>& chosen) {
    const std::size_t first = at_;
    for (; at_ < words_.size(); ++at_) {
      const std::string& word = words_[at_];
      const auto star = word.find('*');
      int from = 1, to = count;
      const std::string low = word.substr(0, star), high = star == word.npos ? low : word.substr(star + 1);
      if ((!low.empty() && !parse(low, from)) || (!high.empty() && !parse(high, to))) break;
      if (from < 1 || to > count || from > to)
        throw InputError(fmt::format("{} {}: expected types from 1 to {}", key, word, count));
      for (int type = from; type <= to; ++type) chosen.insert(type);
    }
    if (at_ == first) throw InputError(fmt::format("{}: expected types", key));
  }

  void masses() {
    const std::size_t first = at_;
    for (double mass = 0; at_ < words_.size() && parse(words_[at_], mass); ++at_) {
      if (!(mass > 0)) throw InputError(fmt::format("m {}: expected a mass of more than 0", words_[at_]));
      given_.held.masses.push_back(mass);
    }
    if (at_ == first) throw InputError("m: expected masses");
  }

  [[noreturn]] void unknown(const std::string& key) const {
    std::vector<std::string> keys = {"b",         "a",     "t",     "m",     "every", "overlap",
                                     "exchanges", "clear", "store", "kbond", "fixed"};
    for (const Option& option : options_) keys.push_back(keyword_of(option.key));
    throw InputError(fmt::format("there is no keyword \"{}\"{}", key,
                                 did_you_mean(key, std::vector<std::string_view>(keys.begin(), keys.end()))));
  }

  const std::vector<std::string>& words_;
  TypeCounts types_;
  std::size_t at_ = 0;
  Keywords given_;
  std::vector<Option> options_;
};

}  // namespace

double Keywords::tolerance() const {
  if (const auto* options = method.get_if<Feedforward::Options>()) return options->tolerance;
  if (const auto* options = method.get_if<Baumgarte::Options>()) return options->tolerance;
  return Baumgarte::Options{}.tolerance;
}

Keywords read_keywords(const std::vector<std::string>& words, const TypeCounts& types) {
  return Reader(words, types).read();
}

}  // namespace taut
