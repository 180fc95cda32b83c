#pragma once

#include <vector>

#include "forcefield/force_field.hpp"
#include "md/state.hpp"

namespace taut {

// Boxes of water that was equilibrated in another: waters of three atoms, O, H, H, in a row.

inline constexpr double kWaterPerNm3 = 34;  // molecules, about

// The atoms alone of waters of any model, whose sites stand behind them. False where there are none.
bool keep_atoms(State& waters);

// Side by side with itself, n times along each edge, every O in its own image of the box.
State tiled(const State& unit, int n);

// All whose O is in the brick of `box`, of a tiling that covers it.
State cut(const State& unit, const Box& box);

// So many of them. Cut a little too wide; of those that come too near to each other across the faces, one
// each is left out; then the centres are drawn together.
State cut(const State& unit, const Box& box, long molecules);

// Moves and turns rigid molecules, of `each` atoms, down their energy until it is `energy`: those that have
// new neighbours give way to each other, and the liquid is as warm as it was. Steepest descent, no molecule
// further than 0.02 nm at once. Whether it came there.
bool relax(const System& sys, ForceField& forces, int each, double energy, State& s);

}  // namespace taut
