#pragma once

#include <vector>

#include "base/vectors.hpp"

namespace taut {

// A massless atom whose position follows from the positions x of other atoms, its parents,
// which may be sites; the kinds and their conventions are OpenMM's. With three sums over the parents,
//     O = Σ w x,   X = Σ w_x x,   Y = Σ w_y x;   Σ w = 1,   Σ w_x = Σ w_y = 0,
// the site is at O + p(X, Y):
//     average        p = 0
//     out of plane   p = c X × Y
//     local          p = a e_x + b e_y + c e_z,   e_x = X/|X|,   e_z = X × Y/|X × Y|,   e_y = e_z × e_x
struct VirtualSite {
  enum class Kind { kAverage, kOutOfPlane, kLocal };
  struct Parent {
    int atom;
    double w;                 // its weight in O
    double w_x = 0, w_y = 0;  // in X and Y
  };

  int atom;
  Kind kind;
  std::vector<Parent> parents;
  Vec3 p = Vec3::Zero();  // (a, b, c) [nm]; out of plane (0, 0, c) [1/nm]

  // At the weighted mean of its parents.
  static VirtualSite average(int atom, std::vector<Parent> parents);
  // At x_i + w₁₂ r₁₂ + w₁₃ r₁₃ + c r₁₂ × r₁₃, of the parents i, j, k; weights (w₁₂, w₁₃, c).
  static VirtualSite out_of_plane(int atom, int i, int j, int k, const Vec3& weights);
  static VirtualSite local(int atom, std::vector<Parent> parents, const Vec3& p);
};

using VirtualSites = std::vector<VirtualSite>;

// An atom that is no site, and its weight in a sum of positions.
struct Weighted {
  int atom;
  double weight;
};
// The atoms, each once, by whose weights w an atom is at Σ w x: itself, or those that a site follows from, through sites
// among its parents. Empty for a site that is at no weighted mean. The sites are in the order of their atoms.
std::vector<Weighted> weighted_atoms_of(const VirtualSites& sites, int atom);

// Puts sites, in the order of their atoms, in their positions. Throws SimulationFailure where X and Y of a local frame are parallel, or one
// of them is zero.
void place_sites(const VirtualSites& sites, Vectors& x);
// Gives sites their velocities, v_s = (∂x_s/∂x) v.
void place_site_velocities(const VirtualSites& sites, const Vectors& x, Vectors& v);
// Hands the forces on sites to their parents, f += (∂x_s/∂x)ᵀ f_s, and sets f_s = 0: f is then −∂U/∂x of the
// energy as a function of the parents alone. Returns what this adds to the virial Σ x fᵀ.
Eigen::Matrix3d hand_to_parents(const VirtualSites& sites, const Vectors& x, Vectors& f);

}  // namespace taut
