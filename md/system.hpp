#pragma once

#include <cstdint>
#include <vector>

#include "base/vectors.hpp"
#include "md/box.hpp"
#include "md/virtual_sites.hpp"

namespace taut {

// A distance that is held: |x_j − x_i| = length.
struct RigidBond {
  int i, j;
  double length;  // [nm]
};

// A distance that is held from one side only: a strut keeps its atoms apart, a rope keeps them together.
enum class Side : std::int8_t {
  kAtMost = -1,  // |x_j − x_i| ≤ length
  kBoth = 0,
  kAtLeast = 1  // |x_j − x_i| ≥ length
};
struct OneSidedBond : RigidBond {
  Side side;
};

// How far the molecule of an atom reaches through the periodic box. A cluster is what rigid bonds and virtual sites
// tie together.
enum class Reach : std::int8_t {
  kWhole,     // not to an image of its own: x_j − x_i of its atoms is as it stands, without the box
  kMolecule,  // it is bonded to its own image: what acts between its clusters is of nearest images
  kCluster    // so is the atom's cluster: its rigid bonds are of nearest images, too
};

// x_j − x_i of neighbours in a molecule that reaches so far, from what it is as it stands.
inline Vec3 within_molecule(Reach reach, const Box& box, const Vec3& r) {
  return reach == Reach::kWhole ? r : box.nearest_image(r);
}

// What does not change during a run. make_system builds it.
//
// A bond may end in a virtual site at a weighted mean of atoms, which bear it by the site's weights:
//     r = x_j − x_i = Σ c x,   σ = ½(|r|² − d²),   ∂σ/∂x = c r for each of them,
// c = w of the second end, −w of the first. An atom bears the bonds that end in it with c = ±1.
struct System {
  Eigen::VectorXd mass;          // [u], n; 0 for an anchored atom, and for a virtual site
  Eigen::VectorXd inv_mass;      // [1/u], n; 0 likewise
  std::vector<RigidBond> bonds;  // m
  std::vector<OneSidedBond> one_sided;
  VirtualSites sites;  // in the order of their atoms
  // By which each atom is where it is, if it is one in which bonds may end: itself, or those of a site. Empty where no
  // bond ends in a site.
  std::vector<std::vector<Weighted>> bearers;
  std::vector<Reach> reach;  // of each atom; empty: all are whole
  // The box that nearest images of rigid bonds are taken in, where a cluster meets its own image, else none. It is the start's:
  // make_barostat() and Python's box refuse to change State::box beside it.
  Box images;

  Reach reach_of(int a) const { return reach.empty() ? Reach::kWhole : reach[a]; }
  // Calls act(atom, c) for those that bear a bond; twice for one that does at both ends.
  template <class Act>
  void for_each_bearer(const RigidBond& bond, const Act& act) const {
    if (bearers.empty()) {
      act(bond.i, -1.0);
      act(bond.j, 1.0);
      return;
    }
    for (const auto& [atom, weight] : bearers[bond.i]) act(atom, -weight);
    for (const auto& [atom, weight] : bearers[bond.j]) act(atom, weight);
  }
  // Its end j less its end i of positions, or of what else each atom has. Places of sites in it are not read.
  Vec3 difference(const RigidBond& bond, const Vectors& of) const {
    if (bearers.empty()) return of.col(bond.j) - of.col(bond.i);
    Vec3 sum = Vec3::Zero();
    for_each_bearer(bond, [&](int a, double c) { sum += c * of.col(a); });
    return sum;
  }
  // r = x_j − x_i
  Vec3 along(const RigidBond& bond, const Vectors& x) const {
    return within_molecule(reach_of(bond.i), images, difference(bond, x));
  }
  // x_j − x_i of neighbours in a molecule
  Vec3 apart(const Box& box, int i, int j, const Vectors& x) const {
    return within_molecule(reach_of(i), box, x.col(j) - x.col(i));
  }
  int atoms() const { return static_cast<int>(mass.size()); }
  int bond_count() const { return static_cast<int>(bonds.size()); }
  // All bonds are numbered together: first the bonds, then the one-sided bonds.
  int all_bonds() const { return bond_count() + static_cast<int>(one_sided.size()); }
  const RigidBond& bond(int k) const {
    return k < bond_count() ? bonds[k] : static_cast<const RigidBond&>(one_sided[k - bond_count()]);
  }
  int side(int k) const { return k < bond_count() ? 0 : static_cast<int>(one_sided[k - bond_count()].side); }
  double reduced_inv_mass(const RigidBond& bond) const;  // Σ c²/m over its atoms: 1/m_i + 1/m_j [1/u]
  bool is_site(int a) const;
  bool is_anchor(int a) const { return mass[a] == 0 && !is_site(a); }
  int anchors() const;
};

// An atom of mass 0 that is no virtual site is an anchor: no force moves it (OpenMM's convention).
// Throws InputError
//  - for a bond that is out of range, joins an atom to itself, repeats another, has no length, or ends in two
//    anchors or in a virtual site at no weighted mean; likewise for one-sided bonds (a pair may have a strut and a
//    rope, but neither beside a bond);
//  - for a bond that is longer than a way round by other bonds or ropes, so that no positions fit;
//  - for a mass that is negative or not finite;
//  - for a virtual site that has a mass, has no parents, has a parent out of range or repeated,
//    follows from itself by way of parents that are sites, or has weights that do not add up.
System make_system(Eigen::VectorXd mass, std::vector<RigidBond> bonds, VirtualSites sites = {},
                   std::vector<OneSidedBond> one_sided = {});

}  // namespace taut
