#pragma once

#include <string>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

double kinetic_energy(const System& sys, const Vectors& v);  // ½ Σ m v² [kJ/mol]
Vec3 momentum(const System& sys, const Vectors& v);          // Σ m v [u·nm/ps]
// Subtracts the centre of mass's velocity from all that can move. Not where a bond ends in an anchor: it
// takes the momentum up, and the atoms it holds would be pushed along their bonds.
void remove_momentum(const System& sys, Vectors& v);

// 3·mobile − rank(bonds) − 3 if the momentum is held at zero.
struct DegreesOfFreedom {
  int mobile = 0;               // atoms that can move
  int rank = 0;                 // independent bonds
  bool momentum_fixed = false;  // total momentum removed, or conserved from zero

  int total() const { return 3 * mobile - rank - (momentum_fixed ? 3 : 0); }
  std::string sum() const;  // "3·648 − 648 − 3 = 1293"
};

// `momentum_fixed` is refused (stays false) where an anchor can take up momentum.
DegreesOfFreedom degrees_of_freedom(const System& sys, int rank, bool momentum_fixed);

double temperature(double kinetic, int dof);  // 2E/(dof·k) [K]; 0 for no degrees of freedom

struct BondErrors {
  double max = 0;  // largest ||r|−d|/d, of one-sided bonds where they are passed; a NaN is larger than any
  double rms = 0;  // root mean square of the same, of bonds held from both sides
  int worst = -1;  // the bond of the largest (System::bond), -1 without bonds
};
BondErrors bond_errors(const System& sys, const Vectors& x);

}  // namespace taut
