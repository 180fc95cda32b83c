#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/range.hpp"

namespace taut {

// For an option that has an effect only if another option has a certain value: whether it has one now, and
// when it would, e.g. Counts{gains == "physical", "with …"}. Setting it without effect is an error.
struct Counts {
  bool read = true;
  const char* where = "";
};

// One option of a method: its name, the field that holds its value, its meaning and its limits.
struct Option {
  struct About {
    const char* unit = "";
    Range range = kAnyNumber;
    Counts counts = {};
    std::vector<std::string_view> words = {};  // the allowed values of a text
  };

  const char* key;
  std::variant<double*, int*, bool*, std::string*, std::optional<double>*> field;
  const char* meaning;
  About about = {};

  std::string value() const;     // as it is written in a scene
  std::string allowed() const;   // "more than 0 and less than 2", "one of a, b"; "" if anything is allowed
  std::string in_words() const;  // "omega_h = 0.7: ωh of each bond … (more than 0 and less than 2)"
};

inline constexpr Range kTolerances{.min = 1e-15, .max = 0.1};

// Throws InputError for the first number out of its range and for an unknown word; options without effect are
// skipped.
void check_options(const std::vector<Option>& options);

}  // namespace taut
