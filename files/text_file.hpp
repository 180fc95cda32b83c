#pragma once

#include <filesystem>
#include <string>

namespace taut {

inline constexpr std::size_t kLongestText = std::size_t(4) << 30;  // [bytes]: XML of ten million atoms

// The name of a file without the ending of a compressed one, .gz or .bz2.
std::filesystem::path without_compression(const std::filesystem::path& file);

// Returns the text of a file, which the commands gzip or bzip2 expand if its name ends in .gz or .bz2. Reads no
// further than the first piece with a character 0, or beyond the longest text: a device such as /dev/zero has no end.
// Throws InputError.
std::string whole_text(const std::filesystem::path& file);

// Returns the contents of a file as they are, or nothing if it does not exist. Throws OutsideError
// where it cannot be read.
std::string contents_of(const std::filesystem::path& file);

}  // namespace taut
