#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut {

// The name that was meant, by what was typed: the first that goes on from it, or else the fewest edits away,
// of which at most one for every three letters of the longer, and one in any case. Empty where none is near.
std::string_view nearest_name(std::string_view typed, const std::vector<std::string_view>& names);

// What a refusal of `typed` ends with: "; did you mean \"rattle\"?", or where no name is near
// "; expected one of shake, rattle", or nothing where there are none.
std::string did_you_mean(std::string_view typed, const std::vector<std::string_view>& names);

// Throws InputError, "method.gains: there is no \"dead-beet\"; did you mean …", unless the name is one of
// them.
void expect_name(std::string_view key, std::string_view name, const std::vector<std::string_view>& names);

}  // namespace taut
