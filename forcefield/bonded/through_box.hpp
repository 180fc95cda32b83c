#pragma once

#include <vector>

#include "forcefield/bonded/bonded_forces.hpp"
#include "md/box.hpp"
#include "md/system.hpp"

namespace taut {

// Bonded forces of molecules that meet their own image through the box. Of each term every atom is the image next to
// the atom before it. The terms are computed on copies of their atoms, placed so, and the forces of copies go to their
// atoms.
class BondedThroughBox {
 public:
  BondedThroughBox() = default;
  // Takes the terms of such molecules out of what is given.
  BondedThroughBox(const System& sys, Terms& terms, std::vector<PairException>& exceptions);

  int pieces() const { return forces_.pieces().count(); }
  BondedForces::KindCounts counts() const { return forces_.counts(); }
  // Throws SimulationFailure as BondedForces does, and for atoms of a term that are over half the box's shortest edge
  // apart, where the nearest image is in doubt.
  BondedForces::KindEnergies add_forces(const Box& box, const Vectors& x, Vectors& f);
  // Σ x⊗f of the copies [kJ/mol]
  Eigen::Matrix3d virial(const Box& box, const Vectors& x);

 private:
  struct Copy {
    int atom;
    int before;  // the atom before it in its term; −1: none
  };
  BondedForces::KindEnergies evaluate(const Box& box, const Vectors& x);
  void throw_with_own_numbers(const Vectors& x) const;

  Terms own_;  // by the atoms' own numbers
  std::vector<Copy> copies_;
  BondedForces forces_;  // on the copies
  Vectors x_, f_;        // of the copies
};

}  // namespace taut
