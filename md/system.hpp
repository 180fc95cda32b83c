#pragma once

#include <cstdint>
#include <vector>

#include "base/vectors.hpp"
#include "md/virtual_sites.hpp"

namespace taut {

// One distance held: |x_j − x_i| = length.
struct RigidBond {
  int i, j;
  double length;  // [nm]
};

// A distance held from one side only: a strut keeps its atoms apart, a rope keeps them together.
enum class Side : std::int8_t {
  kAtMost = -1,  // |x_j − x_i| ≤ length
  kBoth = 0,
  kAtLeast = 1  // |x_j − x_i| ≥ length
};
struct OneSidedBond : RigidBond {
  Side side;
};

// What does not change during a run. Build it with make_system.
struct System {
  Eigen::VectorXd mass;          // [u], n; 0 for an anchored atom, and for a virtual site
  Eigen::VectorXd inv_mass;      // [1/u], n; 0 likewise
  std::vector<RigidBond> bonds;  // m
  std::vector<OneSidedBond> one_sided;
  VirtualSites sites;  // in the order of their atoms

  int atoms() const { return static_cast<int>(mass.size()); }
  int bond_count() const { return static_cast<int>(bonds.size()); }
  // The bonds, then the one-sided ones.
  int all_bonds() const { return bond_count() + static_cast<int>(one_sided.size()); }
  const RigidBond& bond(int k) const {
    return k < bond_count() ? bonds[k] : static_cast<const RigidBond&>(one_sided[k - bond_count()]);
  }
  int side(int k) const { return k < bond_count() ? 0 : static_cast<int>(one_sided[k - bond_count()].side); }
  bool is_site(int a) const;
  bool is_anchor(int a) const { return mass[a] == 0 && !is_site(a); }
  int anchors() const;
};

// Mass 0 anchors an atom that is no virtual site: it never moves (OpenMM's convention).
// Throws InputError for a bond out of range, between an atom and itself, repeated, of no length, to a virtual
// site or between two anchored atoms (one-sided ones likewise; a pair may have one of each side, but none
// beside a bond), for a negative or non-finite mass, and for a virtual site with a mass,
// without parents, with a parent out of range, repeated or itself a site, or with weights that do not add up.
System make_system(Eigen::VectorXd mass, std::vector<RigidBond> bonds, VirtualSites sites = {},
                   std::vector<OneSidedBond> one_sided = {});

}  // namespace taut
