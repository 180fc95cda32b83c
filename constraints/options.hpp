#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/range.hpp"

namespace taut {

// Of an option that counts only beside others: whether it does as they are, and where it would. Said all the
// same, it is refused: Counts{gains == "physical", "with …"}.
struct Counts {
  bool read = true;
  const char* where = "";
};

// One option of a method: its field, and what there is to know of it.
struct Option {
  struct About {
    const char* unit = "";
    Range range = kAnyNumber;
    Counts counts = {};
    std::vector<std::string_view> words = {};  // a text is one of them
  };

  const char* key;
  std::variant<double*, int*, bool*, std::string*, std::optional<double>*> field;
  const char* meaning;
  About about = {};

  std::string value() const;     // as a scene has it
  std::string allowed() const;   // "more than 0 and less than 2", "one of a, b"; "" where anything is
  std::string in_words() const;  // "omega_h = 0.7: ωh of each bond … (more than 0 and less than 2)"
};

inline constexpr Range kTolerances{.min = 1e-15, .max = 0.1};

// Throws InputError for the first number that counts and is out of its range, and for a word there is not.
void check(const std::vector<Option>& options);

}  // namespace taut
