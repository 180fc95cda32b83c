#pragma once

#include <filesystem>
#include <string>

#include "studies/crosscheck.hpp"

namespace taut {

void print_crosscheck(const Crosscheck& c);

// crosscheck.json (all figures and verdicts), crosscheck.csv (every sample of every run), of liquid water
// distances.csv, pictures of them, and report.html; `command` is what was typed.
void write_crosscheck(const Crosscheck& c, const std::string& command, const std::filesystem::path& folder);

}  // namespace taut
