#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "measures/mean_force.hpp"
#include "measures/run_groups.hpp"

namespace taut {

inline constexpr const char* kMeanForce = "mean_force";  // the name of its table and picture

// What groups of runs along the length of a bond of run.tension_of come to: its potential of mean force.
struct MeanForces {
  ScanValues values;      // of the other keys that the scan varies
  std::string bond;       // "bond 0-1", "12 bonds"
  double kT = 0;          // [kJ/mol]
  std::string corrected;  // what stands between the mean force and the potential, in words
  std::string flaw;       // why there is no potential; empty: there is
  std::vector<FreeEnergies> lengths;
  std::optional<double>
      spacing_error;                // of the potential, none where there are too few lengths to tell [kJ/mol]
  std::vector<std::string> doubts;  // why errors may be larger than they are said to be
  std::vector<std::string> notes;   // what the potential is of, and is not

  std::string label() const;
};

// For each setting of the other keys, in the groups' order; none where no bond of run.tension_of has several lengths.
std::vector<MeanForces> mean_forces(const std::vector<RunGroup>& groups);

// Returns what keeps a scene from having a potential of mean force along the bonds of run.tension_of, or an empty text.
std::string flaw_of_mean_force(const Scene& scene);

// The same of scenes along the length: they must have the same bonds, of which those of run.tension_of alone differ.
std::string flaw_of_lengths(const std::vector<const Scene*>& scenes);

// Returns the atoms of the rigid bonds that have not the same length in all of these scenes.
std::vector<std::array<int, 2>> bonds_of_several_lengths(const std::vector<const Scene*>& scenes);

std::string in_words(const MeanForces& of, int width);
nlohmann::ordered_json json_of(const MeanForces& of);
Picture picture_of(
    const std::vector<MeanForces>& all);  // of those that have no flaw; an empty table if all have one

}  // namespace taut
