#pragma once

#include "forcefield/neighbour_list.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// Repulsive beads (Weeks, Chandler and Andersen 1971, doi:10.1063/1.1674820):
//     E = 4ε((σ/r)¹² − (σ/r)⁶) + ε up to r = 2^(1/6)σ, its minimum, where both E and the force reach zero.
class WcaBeads {
 public:
  WcaBeads(const Wca& wca, int atoms, const Box& box);

  double add(const Vectors& x, Vectors& f);  // energy [kJ/mol]

  static double reach(const Wca& wca);  // 2^(1/6)σ [nm]

 private:
  double sigma2_, epsilon_, cutoff_;  // [nm²], [kJ/mol], [nm]
  Box box_;
  NeighbourList list_;
};

}  // namespace taut
