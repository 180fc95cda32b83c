#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "forcefield/terms.hpp"

namespace taut {

// CHARMM's correction map, an energy of two dihedrals together (MacKerell, Feig and Brooks 2004,
// doi:10.1002/jcc.20065), in OpenMM's construction. E is given on an n × n grid of φ and ψ, periodic. In a
// cell of the grid,
//     E(φ, ψ) = Σ c_kl tᵏ uˡ,   k, l = 0 … 3,   t = φ n/2π − row,   u = ψ n/2π − column,
// Hermite's polynomial, which has E, ∂E/∂t, ∂E/∂u and ∂²E/∂t∂u of the grid at the cell's four corners. The
// slopes are those of periodic cubic splines through the points of a line of the grid: ∂E/∂t along t, ∂E/∂u
// along u, and ∂²E/∂t∂u along t through the values of ∂E/∂u.
class CmapSurface {
 public:
  explicit CmapSurface(const Eigen::MatrixXd& points);

  struct Value {
    double energy, of_phi, of_psi;  // E, ∂E/∂φ, ∂E/∂ψ [kJ/mol, kJ/mol/rad]
  };
  Value at(double phi, double psi) const;

 private:
  int n_;
  std::vector<Eigen::Matrix4d> cells_;  // n x n, row by row: c
};

// A CmapTorsion with its surface.
struct CmapPair {
  std::array<int, 4> phi, psi;
  std::shared_ptr<const CmapSurface> surface;
};
std::vector<CmapPair> cmap_pairs(const std::vector<Eigen::MatrixXd>& maps,
                                 const std::vector<CmapTorsion>& torsions);

inline std::array<int, 8> atoms_of(const CmapPair& t) {
  return {t.phi[0], t.phi[1], t.phi[2], t.phi[3], t.psi[0], t.psi[1], t.psi[2], t.psi[3]};
}

// Adds the forces to f and returns the energy [kJ/mol], one pair after the other.
double add_term_forces(std::span<const CmapPair> pairs, const Vectors& x, Vectors& f);

}  // namespace taut
