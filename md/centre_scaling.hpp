#pragma once

#include <vector>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// What a box whose lengths change by factors μ does to its atoms. Groups of them, molecules or what rigid
// bonds tie together, move as wholes by their centres of mass,
//     X → μX,   V → V/μ,   x − X and v − V as they were:
// no bond within a group is stretched or turned, nothing that holds it notices, and (X, P) keep their volume.
class CentreScaling {
 public:
  // group: of each atom, counted from 0.
  CentreScaling(const System& sys, const std::vector<int>& group);

  int groups() const { return static_cast<int>(begin_.size()) - 1; }
  void scale_positions(const Vec3& mu, Vectors& x) const;
  void scale_velocities(const Vec3& mu, Vectors& v) const;  // virtual sites have none in a State

  // Σ M V² along x, y and z, of the groups' centres alone [kJ/mol].
  Vec3 twice_kinetic(const Vectors& v) const;
  // Σ (x − X) f along x, y and z: what of the atoms' virial the centres do not have [kJ/mol].
  Vec3 inner_virial(const Vectors& x, const Vectors& f) const;

 private:
  Vec3 centre(int group, const Vectors& of) const;
  enum class Atoms { kAll, kOfMass };
  void scale(const Vec3& by, Vectors& of, Atoms which) const;

  std::vector<int> begin_, atom_;  // of a group's, in atom_
  std::vector<double> share_;      // as atom_: of the group's mass
  std::vector<double> mass_;       // of each group [u]
};

}  // namespace taut
