#pragma once

#include <filesystem>
#include <string>

#include "studies/crosscheck.hpp"

namespace taut {

void print_crosscheck(const Crosscheck& c);

// Writes crosscheck.json (all figures and verdicts), crosscheck.csv (every sample of every run),
// distances.csv for liquid water, the pictures and report.html. `command` is the command line.
void write_crosscheck(const Crosscheck& c, const std::string& command, const std::filesystem::path& folder);

}  // namespace taut
