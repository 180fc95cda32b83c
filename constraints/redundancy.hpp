#pragma once

#include <string>
#include <vector>

#include "md/system.hpp"

namespace taut {

// A is singular if a bond's length follows from the lengths of other bonds. There are two cases, which are
// told apart by displacing the atoms a little:
// - redundant: the dependence remains after the displacement. The shape is overdetermined (methane with all
//   ten
//   distances held, a cube with all its diagonals). Such bonds may be left out; the motion is the same. So may those
//   of a linkage that depend on others wherever it moves, as one of three parallel cranks of a plate. If it is flat, that
//   holds for motion in its plane.
// - degenerate: the dependence exists only in this placement (a straight angle held by a 1–3 bond, a fully
//   braced
//   flat ring). No force along the bonds acts sideways here, and leaving bonds out would not help.
struct Redundancy {
  std::vector<int> redundant;   // bonds, each of which follows from the bonds that are not listed
  std::vector<int> degenerate;  // bonds that follow from others in this placement only

  bool none() const { return redundant.empty() && degenerate.empty(); }
  int rank(const System& sys) const {
    return sys.bond_count() - static_cast<int>(redundant.size() + degenerate.size());
  }
};

// Finds the dependent bonds at positions x [nm], 3 × n. A pivot of A below 1e-8 of its diagonal counts as 0,
// so that an angle whose ends are held, too, counts as straight within about 1e-4 rad of it (4e-5 to 2e-4,
// depending on the masses). Two bonds alone never depend on each other, however they lie.
Redundancy find_redundancy(const System& sys, const Vectors& x);

// Returns one line that names the bonds and says what to do.
std::string explain(const Redundancy& redundancy, const System& sys);

// Returns the same system without these bonds.
System without(const System& sys, const std::vector<int>& bonds);

// With redundant bonds only the force Jᵀλ is unique, not λ. Returns the λ of smallest norm, in which all
// bonds share the load. `full` has all bonds; `lambda` has the multipliers of the bonds that are not in
// `left_out`, in their order.
Eigen::VectorXd least_norm_multipliers(const System& full, const Vectors& x, const std::vector<int>& left_out,
                                       const Eigen::VectorXd& lambda);

}  // namespace taut
