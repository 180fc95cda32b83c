#pragma once

// Pairs of OpenMM's files to test with. Without OpenMM's headers, which ask for C++17.

#include <filesystem>
#include <string>

#include "temporary_folder.hpp"

namespace taut::tests {

struct Files {
  std::filesystem::path system, state;
};

// Those in tests/data.
Files data(const std::string& name);

using Folder = TemporaryFolder;

// The same system with its rigid bonds longer by up to 6e-6 of their length, no two neighbours alike: OpenMM
// then takes no water for SETTLE's, which keeps distances as float, and solves them in double precision.
Files without_settle(const Files& files, const Folder& folder);

// A periodic melt (openmm_models.hpp) with three atoms of mass 0.
Files anchored_melt(const Folder& folder);

}  // namespace taut::tests
