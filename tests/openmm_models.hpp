#pragma once

// Systems made through OpenMM's own interface, for tests of what taut makes of them.

#include <OpenMM.h>

#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "md/box.hpp"
#include "openmm_folder.hpp"

namespace taut::tests {

// 32 chains of 7 beads on a shaken lattice, in a box of 2.4 nm. Every other bond is rigid (0-1, 2-3, 4-5; the
// last bead is on none, as an anchor of OpenMM's must be). Random masses, charges and sizes; angles;
// exceptions as in Amber's force fields.
class Melt {
 public:
  static constexpr int kChains = 32, kLength = 7, kAtoms = kChains * kLength;
  static constexpr double kEdge = 2.4;  // [nm]
  Box box{Vec3(kEdge, kEdge, kEdge)};

  explicit Melt(unsigned seed);

  OpenMM::System system;
  OpenMM::HarmonicBondForce* bonds;
  OpenMM::HarmonicAngleForce* angles;
  OpenMM::NonbondedForce* nonbonded;
  std::vector<OpenMM::Vec3> x, v;
  std::map<std::string, double> parameters;  // of the Context, where not the default

  OpenMM::PeriodicTorsionForce* add_torsions();
  OpenMM::RBTorsionForce* add_rb_torsions();
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  void make_periodic();  // cutoff 1 nm
  void skew();           // its box

  // Puts every atom into the box on its own, so that molecules break, and has OpenMM mend them.
  void break_across_box();

  Files write(const Folder& folder) const;
  std::filesystem::path write_system(const Folder& folder) const;

 private:
  template <class Use>
  void each_torsion(Use use);

  std::mt19937 random_;
};

}  // namespace taut::tests
