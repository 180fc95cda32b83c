#pragma once

#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// What of a scene LAMMPS does otherwise, or not at all, for the head of the input that write_data.hpp writes: a comment
// each.
std::string describe_differences(const Scene& scene);

}  // namespace taut
