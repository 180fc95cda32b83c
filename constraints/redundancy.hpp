#pragma once

#include <string>
#include <vector>

#include "md/system.hpp"

namespace taut {

// Bonds that follow from other bonds leave A singular. Two cases, told apart by shaking the atoms a little:
// - redundant: the bonds follow from the others there, too. The shape is overdetermined (methane with all
//   ten distances held, a cube with all its diagonals): they may be left out, and the motion is the same.
// - degenerate: the bonds follow from the others in this placement alone (a straight angle that a 1-3 bond
//   holds, a flat ring fully braced). No force along the bonds acts sideways here, and leaving something out
//   would not mend it.
struct Redundancy {
  std::vector<int> redundant;   // bonds, each follows from those that are not listed
  std::vector<int> degenerate;  // bonds that follow from others only here

  bool none() const { return redundant.empty() && degenerate.empty(); }
  int rank(const System& sys) const {
    return sys.bond_count() - static_cast<int>(redundant.size() + degenerate.size());
  }
};

// At positions x [nm], 3 × n. A pivot of A below 1e-8 of its diagonal counts as none. So an angle that is held
// by its ends as well counts as straight from about 1e-4 rad on (4e-5 to 2e-4, as the masses are). Two bonds
// alone, however they lie, never depend on each other.
Redundancy find_redundancy(const System& sys, const Vectors& x);

// One line: which bonds, and what to do.
std::string explain(const Redundancy& redundancy, const System& sys);

// The same system with some bonds left out.
System without(const System& sys, const std::vector<int>& bonds);

// With redundant bonds the multipliers are not unique, only their force Jᵀλ is. Those of least norm: all
// bonds share the load. `full` has all bonds, `lambda` those of the bonds not in `left_out`, in their order.
Eigen::VectorXd least_norm_multipliers(const System& full, const Vectors& x, const std::vector<int>& left_out,
                                       const Eigen::VectorXd& lambda);

}  // namespace taut
