#pragma once

#include <string>
#include <vector>

#include "studies/crosscheck.hpp"

namespace taut {

// OpenMM's runs, the fine one, then taut's.
std::vector<const Track*> all_tracks(const Crosscheck& c);

// How far a run was from the fine one when that was last known [nm]; −1: never.
double last_from_truth(const Track& track);

std::string crosscheck_json(const Crosscheck& c);  // all figures and verdicts
std::string samples_csv(const Crosscheck& c);      // every sample of every run
std::string distances_csv(const Crosscheck& c);    // of liquid water, g(r)

}  // namespace taut
