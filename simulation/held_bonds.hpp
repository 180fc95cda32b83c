#pragma once

#include <vector>

#include "constraints/projection.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// The rigid bonds of run.tension_of. Along the distance r of one of them, which is held at d, the distribution of the
// system in which r is free is
//     P(d) ∝ exp(−A/kT)⟨w⟩,   dA/dd = −⟨τ⟩,   w = √μ,   1/μ = det A/(d² det A_o) = 1/(d²(A⁻¹)_kk),
// where τ is the tension, the averages are of the held system, A = J M⁻¹Jᵀ of σ = ½(r² − d²) is of all bonds and A_o of
// all others: μ is the mass that moves along r while the others hold (Fixman 1974, doi:10.1073/pnas.71.8.3050; Sprik
// and Ciccotti 1998, doi:10.1063/1.477419; den Otter and Briels 1998, doi:10.1063/1.477019). Under the metric correction,
// which takes √det A out, w = d. Of several bonds, which are held at one d together, this is each one's P(d) only where
// they do not act on each other.
class HeldBonds {
 public:
  // full: with the bonds that sys lacks because they follow from others.
  HeldBonds(const System& full, const System& sys, const RunSettings& run);

  // The mean over the bonds. λ: of all bonds of `full`; the projector has just found multipliers here. Springs have no
  // weight, nor have bonds of one cluster, whose distances are held together, nor those whose cluster lost a bond.
  HeldTension of(const Eigen::VectorXd& lambda, Projector* projector) const;

 private:
  std::vector<int> bonds_, kept_;  // numbers in `full`, and in sys, where there is a weight
  std::vector<double> length_;     // [nm]
  int all_kept_;
  bool metric_correction_, have_weight_;
};

}  // namespace taut
