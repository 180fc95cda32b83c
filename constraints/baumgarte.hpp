#pragma once

#include <limits>

#include "constraints/direct_solver.hpp"
#include "constraints/gains.hpp"
#include "constraints/gaps.hpp"

namespace taut {

// Acceleration-level stabilization (Baumgarte 1972, doi:10.1016/0045-7825(72)90018-7): instead of σ̈ = 0
// demand σ̈ + 2ασ̇ + β²σ = 0, with v the velocity at the end of the step:
//     A λ = −(J M⁻¹F + |v_ij|² + 2α J v + β²σ),   v = w + (h/2) M⁻¹Jᵀλ,   w = v_half + (h/2) M⁻¹F.
// The damping's share of λ goes to the left, |v_ij|² is taken with the λ known before:
//     (1 + αh) A λ = −(J M⁻¹F + |v*_ij|² + 2α J w + β²σ),   v* = w + (h/2) M⁻¹Jᵀλ_before.
// Differs: damping is implicit in the new velocity. Cost: one factorization and one solve a step; each
// further pass (|v*_ij|² with the λ just found) one more solve.
class Baumgarte : public EmptyGaps {
 public:
  static constexpr const char* kName = "baumgarte";
  static constexpr const char* kSummary =
      "feedback on the bond error in the acceleration, one linear solve a step";

  struct Options {
    std::string gains = "reversible";
    std::optional<double> alpha_per_ps = {}, beta_per_ps = {};
    int passes = 1;

    void describe(auto&& visit) {
      visit("gains", gains, "critical, dead-beat, reversible or numbers");
      visit("alpha_per_ps", alpha_per_ps, "damping α [1/ps], in place of the named one");
      visit("beta_per_ps", beta_per_ps, "stiffness β [1/ps], in place of the named one");
      visit("passes", passes, "solves a step");
    }
  };

  Baumgarte(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s);

  const Eigen::VectorXd& lambda() const { return lambda_; }
  double promised_error() const { return std::numeric_limits<double>::infinity(); }
  std::string setting() const;
  const Gains& gains() const { return gains_; }

 private:
  Gains gains_;
  int passes_;
  double h_;
  DirectSolver solver_;
  Vectors r_, w_ij_;                // 3 × m
  Vectors y_;                       // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd known_, lambda_;  // m
};

}  // namespace taut
