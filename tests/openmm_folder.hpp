#pragma once

// Pairs of OpenMM's files to test with. Without OpenMM's headers, which ask for C++17.

#include <filesystem>
#include <string>

#include "temporary_folder.hpp"

namespace taut::tests {

struct Files {
  std::filesystem::path system, state;
};

// Those in tests/data, where large ones are compressed.
inline Files data(const std::string& name) {
  const auto file = [&](const char* kind) {
    const std::filesystem::path plain = TAUT_TEST_DATA "/" + name + kind, packed = plain.string() + ".gz";
    return std::filesystem::exists(packed) ? packed : plain;
  };
  return {file(".system.xml"), file(".state.xml")};
}

using Folder = TemporaryFolder;

// The same system with its rigid bonds longer by up to 6e-6 of their length, no two neighbours alike: OpenMM
// then takes no water for SETTLE's, which keeps distances as float, and solves them in double precision.
Files without_settle(const Files& files, const Folder& folder);

// The same system with its springs between two atoms rigid, at the lengths that they have in the State.
Files all_bonds_rigid(const Files& files, const Folder& folder);

// A periodic melt (openmm_models.hpp) with three atoms of mass 0.
Files anchored_melt(const Folder& folder);

}  // namespace taut::tests
