#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

// Those of the named files that are in a folder.
std::vector<std::string> present(const std::filesystem::path& folder, const std::vector<std::string>& names);

// FOLDER as set_aside() names the new folder, but for its number: without a slash at the end, and where a
// link leads.
std::filesystem::path folder_to_number(const std::filesystem::path& folder);

// Moves the named files, which are there, to a new folder beside theirs: FOLDER.1, or the first number that
// is free. Returns that. What else is in FOLDER stays. Throws OutsideError.
std::filesystem::path set_aside(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace taut
