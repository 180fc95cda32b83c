#pragma once

#include <vector>

#include "forcefield/force_field.hpp"
#include "md/state.hpp"

namespace taut {

// Fills boxes with water that was equilibrated in another box. Waters are three consecutive atoms O, H, H.

// Removes the sites of any water model, which follow each molecule's atoms. Returns false if these are not
// waters.
bool remove_sites(State& waters);

// Repeats a box n times along each edge, with every O in its image of the box.
State tiled(const State& unit, int n);

// Returns the waters of a tiling whose O is in the rectangular cell of `box`.
State cut(const State& unit, const Box& box);

// Returns `count` of them: cuts a slightly too large region, removes one water of each pair that is too near
// across a face, and scales the centres to the box.
State cut(const State& unit, const Box& box, long molecules);

// Translates and rotates rigid molecules by steepest descent, with all other atoms at rest, until the potential energy is
// `energy`, so that molecules with new neighbours relax and the liquid keeps its temperature. No molecule
// moves by more than 0.02 nm per iteration. Returns whether the energy was reached.
struct RigidMolecules {
  Eigen::Index first, last;  // their atoms
  int each;                  // atoms of one

  Eigen::Index count() const { return (last - first) / each; }
};
bool relax(const System& sys, ForceField& forces, const std::vector<RigidMolecules>& molecules, double energy,
           State& s);

}  // namespace taut
