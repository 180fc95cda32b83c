#pragma once

#include <vector>

#include "base/vectors.hpp"

namespace taut {

// A massless atom whose place follows from those of others, its parents: OpenMM's virtual sites, by its
// conventions. With three sums over the parents' positions x,
//     O = Σ w x,   X = Σ w_x x,   Y = Σ w_y x;   Σ w = 1,   Σ w_x = Σ w_y = 0,
// it is at O + p(X, Y):
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

  // Between its parents.
  static VirtualSite average(int atom, std::vector<Parent> parents);
  // At x_i + w₁₂ r₁₂ + w₁₃ r₁₃ + c r₁₂ × r₁₃, of the parents i, j, k; weights (w₁₂, w₁₃, c).
  static VirtualSite out_of_plane(int atom, int i, int j, int k, const Vec3& weights);
  static VirtualSite local(int atom, std::vector<Parent> parents, const Vec3& p);
};

using VirtualSites = std::vector<VirtualSite>;

// Throws SimulationFailure where X and Y of a local frame are in line, or one of them is of no length.
void place_sites(const VirtualSites& sites, Vectors& x);
// v_s = (∂x_s/∂x) v
void place_site_velocities(const VirtualSites& sites, const Vectors& x, Vectors& v);
// f += (∂x_s/∂x)ᵀ f_s for the parents, f_s = 0: −∂U/∂x of the energy as a function of the parents alone.
// Returns what it adds to Σ x fᵀ.
Eigen::Matrix3d hand_to_parents(const VirtualSites& sites, const Vectors& x, Vectors& f);

}  // namespace taut
