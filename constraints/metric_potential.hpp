#pragma once

#include "constraints/elimination.hpp"
#include "md/system.hpp"

namespace taut {

// Rigid bonds weigh a molecule's shapes by √det A, A = J M⁻¹Jᵀ, which stiff springs do not. Fixman's potential
//     U = ½kT ln det A,   dU = ½kT tr(A⁻¹ dA),
// takes that weight out, so that rigid bonds have the statistics of a flexible chain (Fixman 1974,
// doi:10.1073/pnas.71.8.3050). A is factored as DirectSolver does: A = L D Lᵀ, ln det A = Σ ln d_k. The gradient
// needs Z = A⁻¹ only where L has entries. These follow from the last column to the first (Takahashi, Fagan and
// Chen 1973; Erisman and Tinney 1975, doi:10.1145/360680.360704),
//     Z_jk = −Σ_i Z_ji l_ik,   Z_kk = 1/d_k − Σ_i l_ik Z_ik,   i and j over the rows of column k,
// and with s_kl = ±1/m of the atom that bonds k and l share (bond_graph.hpp), s_kk = 1/m_i + 1/m_j,
//     ∂U/∂r_k = kT Σ_l Z_kl s_kl r_l.
// The cost is linear in the number of bonds for chains, trees and small molecules. Nothing is allocated.
class MetricPotential {
 public:
  explicit MetricPotential(const System& sys);

  // f += −∂U/∂x; returns U [kJ/mol], which is −∞ or no number where bonds depend on each other. kT in kJ/mol.
  double add_forces(const Vectors& x, double kT, Vectors& f);

 private:
  void factor();
  void invert();

  System sys_;
  Eigen::VectorXd reduced_inv_mass_;
  Elimination plan_;
  std::vector<std::ptrdiff_t> first_update_;  // of each column, an index into plan_.update
  Vectors r_, g_;                             // bond vectors, and Σ_l Z_kl s_kl r_l
  Eigen::VectorXd l_, d_, z_, z_diagonal_;
};

}  // namespace taut
