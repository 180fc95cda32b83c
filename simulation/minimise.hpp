#pragma once

#include <functional>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

class ForceField;

// Steepest descent on the manifold of the bonds, for rough starts. The way is the force without its part
// along the bonds, f − Jᵀ(JJᵀ)⁻¹Jf (masses have no say in a minimum); after each move the bonds are brought
// back to their lengths exactly. A move that lowers the energy is kept and the next one is 1.2 times as far,
// else it is taken back and halved. However high the overlaps, no atom goes further than kLongestMove at
// once. Ends where no atom's force is above the goal's, where no move helps any more, or after its most moves.
struct Minimised {
  int moves = 0;
  double energy_before = 0, energy = 0;  // [kJ/mol]
  double largest_force = 0;              // tangent, on one atom [kJ/mol/nm]
};

// What to reach. A force of 0 asks for nothing.
struct MinimiseGoal {
  double force = 0;       // on every atom, at most [kJ/mol/nm]
  int most_moves = 5000;  // kept or taken back
  bool soft = false;      // atoms that overlap are pushed apart first, by push_apart() of soft_start.hpp
};

inline constexpr double kLongestMove = 0.05;  // [nm]

// Called before every move with what has been reached. It may throw.
using OnMove = std::function<void(const Minimised& so_far)>;

// s.x, first brought to the bonds' lengths, ends with them exact. Throws SimulationFailure for a start
// whose energy is no number (two atoms in one place).
Minimised minimise(const System& sys, ForceField& forces, const MinimiseGoal& goal, State& s,
                   const OnMove& on_move = {});

}  // namespace taut
