#pragma once

#include "constraints/redundancy.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// The scene without the bonds that follow from others, and with a note of it. Throws InputError where
// run.redundant does not ask for that, and where bonds cannot act in the placement of its start.
Scene without_redundant_bonds(Scene scene, const Redundancy& redundancy);
Scene without_redundant_bonds(Scene scene);

// The bonds that are held give those that were left out a length. A line for each that was said to have
// another.
std::vector<std::string> contradicted_lengths(const System& full, const std::vector<int>& left_out,
                                              const Vectors& x);
// A line for each that has come to have another by more than a hundredth.
std::vector<std::string> lost_lengths(const System& full, const std::vector<int>& left_out, const Vectors& x);

}  // namespace taut
