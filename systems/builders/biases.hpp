#pragma once

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Reads every [[bias]] of a scene whose atoms are placed, and adds it to the scene's terms. What is not said of its
// walls is where the variable is at the start. Molecules of one group are brought together, by vectors of the box.
// Throws LocatedError. While keys are only described, it reads the keys and adds nothing.
void read_biases(const TomlTable& root, Scene& scene);

// Moves whole molecules by vectors of the box so that those of one group stand together at nearest images of its
// first atom, whose molecule stays; the first group that has a molecule decides. Returns how many it moved.
int bring_together(const std::vector<Bias>& biases, const System& sys, const Terms& terms, const Box& box,
                   Vectors& x);

// Returns a bias in a line: "arm: distance of 10 and 12 atoms, ½·500 kJ/mol/nm² beyond 1.2 nm".
std::string in_words(const Bias& bias);

}  // namespace taut
