#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

// Returns those of the named files that exist in a folder.
std::vector<std::string> present(const std::filesystem::path& folder, const std::vector<std::string>& names);

// Returns the name of the backup folder without its number: the folder without a trailing slash, links
// resolved.
std::filesystem::path folder_to_number(const std::filesystem::path& folder);

// Moves the named files, which must exist, to a new folder beside theirs: FOLDER.1, or the first free number.
// Returns that folder. Other files stay in FOLDER. Throws OutsideError.
std::filesystem::path set_aside(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace taut
