#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "constraints/active_set.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/methods/gains.hpp"
#include "constraints/methods/guess.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Acceleration-level stabilization (Baumgarte 1972, doi:10.1016/0045-7825(72)90018-7): instead of σ̈ = 0
// demand σ̈ + 2ασ̇ + β²σ = 0, with v the velocity at the end of the step:
//     A λ = −(J M⁻¹F + |v_ij|² + 2α J v + β²σ),   v = w + (h/2) M⁻¹Jᵀλ,   w = v_half + (h/2) M⁻¹F.
// The part of the damping that contains λ moves to the left-hand side; |v_ij|² is taken with a guess λ*:
//     (1 + αh) A λ = −(J M⁻¹F + |v*_ij|² + 2α J w + β²σ),   v* = w + (h/2) M⁻¹Jᵀλ*   (implicit).
// In a motion with σ = 0 at every step, J v is not zero but −½h² v_ij·a_ij, and damping it loses energy in
// proportion to αh³. Damping the centred rate of the bond, (σ₊ − σ₋)/2h = J v + ½h² v_ij·a_ij, loses none:
//     (1 + αh) A λ = −(J M⁻¹F + |v*_ij|² + 2α (J w + ½h² v*_ij·a*_ij) + β²σ)                 (centred).
// Likewise J a + |v_ij|² is not the second difference of σ: (σ₊ − 2σ + σ₋)/h² contains ¼h²|a_ij|² as well,
// which drives σ and, because the damping lags, feeds energy into oscillations. With both rates as
// differences (the default),
//     (1 + αh) A λ = −(J M⁻¹F + |v*_ij|² + ¼h²|a*_ij|² + 2α (J w + ½h² v*_ij·a*_ij) + β²σ)   (discrete),
// the only energy fed comes from the error of λ*: −(1 + αh)h³ (v_ij + ½h(a_ij + y_ij))·y_ij, y = M⁻¹Jᵀ(λ* −
// λ). Older codes take v_half in the damping:
//     A λ = −(J M⁻¹F + |v*_ij|² + 2α J v_half + β²σ)                                        (lagged).
// guess.hpp extrapolates λ* from the previous steps. propagator.hpp has roots, stability limits and floors;
// constraints/README.md derives them. With `sweeps` > 0 the system is not factored: Gauss–Seidel sweeps over
// the bonds start from λ*, as in rigid-body engines, and σ feeds the remaining error back in the next step. A
// one-sided bond (s = 1 for a strut, −1 for a rope) must keep sσ₊ ≥ 0 at the end of the coming step, with sλ
// ≥ 0 and λσ₊ = 0 (ActiveSet): the discrete law with dead-beat gains as an inequality. Its λ is 0 until σ
// would change sign. With α = β = 0 the condition is only sσ̈ ≥ 0 once sσ ≤ 0, so that the bond keeps the
// speed with which it arrived. Cost: one factorization and one solve a step; each further pass (v*, a* with
// the λ just found) takes one more solve.
class Baumgarte : public ConstraintMethod {
 public:
  struct Options {
    std::string gains = "reversible";
    std::string damping = "discrete";
    std::optional<double> alpha_per_ps = {}, beta_per_ps = {};
    double reduction = 0;
    double stiffness = 4.5e5;
    int passes = 1;
    int sweeps = 0;

    std::vector<Option> describe() {
      const bool named = !(alpha_per_ps && beta_per_ps);  // at least one of them
      return {
          {"gains",
           &gains,
           "how α and β are chosen",
           {.counts = {named || gains == "numbers", "without both alpha_per_ps and beta_per_ps"},
            .words = gain_names()}},
          {"damping", &damping, "whose rate is damped, and which σ̈ is asked for", {.words = damping_names()}},
          {"alpha_per_ps", &alpha_per_ps, "damping α, in place of the named one", {.unit = "1/ps"}},
          {"beta_per_ps", &beta_per_ps, "stiffness β, in place of the named one", {.unit = "1/ps"}},
          {"reduction",
           &reduction,
           "of an error a step, for gains = \"rattle\" or \"swept\" (see taut calibrate)",
           {.range = {.min = 0, .max = 1, .below_max = true},
            .counts = {named && (gains == "rattle" || gains == "swept"),
                       "with method.gains = \"rattle\" or \"swept\""}}},
          {"stiffness",
           &stiffness,
           "of the real bond, for gains = \"physical\"",
           {.unit = "kJ/mol/nm²",
            .range = kPositive,
            .counts = {named && gains == "physical", "with method.gains = \"physical\""}}},
          {"passes", &passes, "solves a step", {.range = {.min = 1}}},
          {"sweeps",
           &sweeps,
           "more than 0: so many sweeps from λ* in place of a factorization",
           {.range = {.min = 0}}}};
    }
    GainChoice choice() const {
      return {.name = gains,
              .alpha_per_ps = alpha_per_ps,
              .beta_per_ps = beta_per_ps,
              .reduction = reduction,
              .stiffness = stiffness};
    }
  };

  Baumgarte(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s);  // starts from lambda()

  void serialize(Archive& archive) override {
    archive(lambda_, before_, before_that_, steps_);
    archive.demand(0 <= steps_ && steps_ <= 3);
  }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::array<Eigen::VectorXd*, 3> past() { return {&lambda_, &before_, &before_that_}; }
  int& steps_known() { return steps_; }
  std::string setting() const override { return setting_; }

 private:
  void guess_lambda();
  void solve_by_sweeps(const System& sys);
  void look_ahead(const System& sys, const Push& push, const State& s, int k);
  void want_one_sided(const System& sys, const Push& push, int k);

  Damping damping_;
  std::vector<Gains> gains_;    // m
  std::vector<Guess> guesses_;  // m
  int passes_, sweeps_;
  DirectSolver solver_;
  Vectors r_, w_ij_, a_ij_;                        // 3 × m, a_ij without constraint forces
  Vectors y_;                                      // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd known_, wanted_;                 // m
  Eigen::VectorXd lambda_, before_, before_that_;  // m, of the last three steps, newest first
  int steps_ = 0;                                  // how many of the three are known
  std::string setting_;
  std::optional<ActiveSet> active_set_;  // only with one-sided bonds
  bool corrects_ = true;
};

// Returns the coefficients of each bond's λ*.
std::vector<Guess> guesses_of(const System& sys, Damping damping);

// Returns gains, damping and number of solves in one line.
std::string describe_baumgarte(const Baumgarte::Options& options, const std::vector<Gains>& gains, double h);

}  // namespace taut
