#pragma once

#include <vector>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Moves atoms with a box whose edges change by factors μ. Groups of atoms (molecules, or what rigid bonds tie
// together) move as wholes by their centres of mass,
//     X → μX,   V → V/μ,   x − X and v − V as they were.
// No bond within a group is stretched or turned, and the volume of phase space (X, P) is kept.
class CentreScaling {
 public:
  // group: the group of each atom, counted from 0.
  CentreScaling(const System& sys, const std::vector<int>& group);

  int groups() const { return static_cast<int>(begin_.size()) - 1; }
  void scale_positions(const Vec3& mu, Vectors& x) const;
  void scale_velocities(const Vec3& mu, Vectors& v) const;  // virtual sites have none in a State

  // Σ M V² of the groups' centres, along x, y and z [kJ/mol].
  Vec3 twice_kinetic(const Vectors& v) const;
  // The same after forces f have acted for a time [ps]. Those within a group cancel.
  Vec3 twice_kinetic(const Vectors& v, double time, const Vectors& f) const;
  // Σ (x − X) f along x, y and z: the part of the atoms' virial that their centres lack [kJ/mol].
  Vec3 inner_virial(const Vectors& x, const Vectors& f) const;

 private:
  Vec3 centre(int group, const Vectors& of) const;
  enum class Atoms { kAll, kOfMass };
  void scale(const Vec3& by, Vectors& of, Atoms which) const;

  std::vector<int> begin_, atom_;  // group g has the atoms atom_[begin_[g]] … atom_[begin_[g + 1] − 1]
  std::vector<double> share_;      // of each entry of atom_: its share of the group's mass
  std::vector<double> mass_;       // of each group [u]
};

}  // namespace taut
