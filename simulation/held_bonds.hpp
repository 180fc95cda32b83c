#pragma once

#include <vector>

#include "constraints/projection.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// The rigid bonds of run.tension_of. Along the distance r of one of them, which is held at d, the distribution of the
// system in which r is free is
//     P(d) ∝ exp(−A/kT)⟨w⟩,   dA/dd = −⟨τ⟩,   w = √μ,   1/μ = det A/det A_o = 1/(d²(A⁻¹)_kk),
// where τ is the tension, the averages are of the held system, A = J M⁻¹Jᵀ is of all bonds and A_o of all others: μ is
// the mass that moves along r while the others hold (Fixman 1974, doi:10.1073/pnas.71.8.3050; Sprik and Ciccotti 1998,
// doi:10.1063/1.477419; den Otter and Briels 1998, doi:10.1063/1.477019). Under the metric correction, which takes √det A
// with σ = ½(r² − d²) out, w = d.
class HeldBonds {
 public:
  // Throws InputError where a bond was dropped as redundant.
  HeldBonds(const System& sys, const RunSettings& run);

  // The mean over the bonds. λ: of all bonds; the projector has just found multipliers here. Springs have no weight, nor
  // have bonds of one cluster, whose distances are held together.
  HeldTension of(const Eigen::VectorXd& lambda, Projector* projector) const;

 private:
  std::vector<int> bonds_;
  std::vector<double> length_;  // [nm]
  int all_bonds_;
  bool metric_correction_, apart_;
};

}  // namespace taut
