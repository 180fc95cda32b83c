#pragma once

#include <string>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

double kinetic_energy(const System& sys, const Vectors& v);  // ½ Σ m v² [kJ/mol]
Vec3 momentum(const System& sys, const Vectors& v);          // Σ m v [u·nm/ps]
// Subtracts the velocity of the centre of mass from all atoms that can move. Do not call it where a bond ends
// in an anchor: the anchor takes up momentum, and the atoms it holds would be pushed along their bonds.
void remove_momentum(const System& sys, Vectors& v);

// 3·mobile − rank(bonds) − momenta that are held at zero.
struct DegreesOfFreedom {
  int mobile = 0;  // atoms that can move
  int rank = 0;    // independent bonds
  int fixed = 0;   // momenta removed, or conserved from zero (md/rigid_motions.hpp)

  int total() const { return 3 * mobile - rank - fixed; }
  std::string sum() const;  // "3·648 − 648 − 3 = 1293"
};

DegreesOfFreedom degrees_of_freedom(const System& sys, int rank, int fixed);
DegreesOfFreedom degrees_of_freedom(const System& sys, int rank, bool fixed) = delete;  // how many?

double temperature(double kinetic, int dof);  // 2E/(dof·k) [K]; 0 for no degrees of freedom

struct BondErrors {
  double max =
      0;  // largest ||r| − d|/d; a one-sided bond counts where it is passed; NaN is larger than any number
  double rms = 0;  // root mean square of the same over the bonds that are held from both sides
  int worst = -1;  // the bond with the largest error (System::bond), −1 without bonds
};
BondErrors bond_errors(const System& sys, const Vectors& x);

}  // namespace taut
