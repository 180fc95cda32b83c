#pragma once

#include <string>
#include <vector>

#include "md/system.hpp"

namespace taut {

// Bonds that follow from other bonds leave A singular. Two cases, told apart by shaking the atoms a little:
// - redundant: the shape is overdetermined (methane with all ten distances held): the bonds follow wherever
// the atoms
//   are, and may be left out without changing the motion;
// - degenerate: only this placement is singular (a straight angle held by a 1–3 bond, a flat ring fully
// braced): there no
//   force along the bonds can act sideways, and nothing can be left out that would mend it.
struct Redundancy {
  std::vector<int> redundant;   // bonds, each follows from those not listed
  std::vector<int> degenerate;  // bonds that only here follow from others

  bool none() const { return redundant.empty() && degenerate.empty(); }
  int rank(const System& sys) const {
    return sys.bond_count() - static_cast<int>(redundant.size() + degenerate.size());
  }
};

// At positions x [nm], 3 × n. A pivot of A below 1e-8 of its diagonal counts as none. An angle that is held by
// its ends as well counts as straight, so, from about 1e-4 rad on (4e-5 to 2e-4, as the masses are). Two bonds
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
