#pragma once

#include <string>

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Reads every [[motion]] of a scene whose atoms are placed. Throws LocatedError. While keys are only described, it reads
// the keys and adds nothing.
void read_motions(const TomlTable& root, Scene& scene);

// Returns a motion in a line: "motion 0: 64 anchors at [0.1, 0, 0] nm/ps".
std::string in_words(const AnchorMotion& motion, std::size_t number);

}  // namespace taut
