#pragma once

#include <array>
#include <string>

#include "constraints/direct_solver.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Baumgarte with its truncation fed forward. The residual that no gain removes is known before the step is
// taken: with w the half-step velocity and F the force at x, the multipliers λ bring the bonds to
//     δ(λ) = h w + h² M⁻¹(F + Jᵀλ),      σ_next(λ) = σ + J δ + ½|δ_ij|²      (exact, σ is quadratic).
// λ is extrapolated from the steps before and corrected by one linear solve,
//     A' Δλ = −σ_next/h²,   A' = J(x + δ) M⁻¹ J(x)ᵀ = ∂σ_next/∂λ / h²   (exact: a Newton step),
// which leaves ½|h²M⁻¹JᵀΔλ|², the square of what extrapolation missed. What is left returns as σ in the next
// step: the feedback of a Baumgarte law with (βh)² = 2, αh = 1 on the error alone. It cools, by h¹¹
// (README.md, "feedforward"): the default tolerance is where that no longer counts.
// Where ½(σ_next/(r_next·r))² before the solve (of one bond alone, just what the solve leaves, over d²)
// passes `tolerance`, the step takes another solve: large steps, collisions. stats.iterations tells. The
// velocities are leap-frog's mean velocities: J v = −½h² v·a, not zero; they are not projected. Start-up: λ
// of the first step is iterated until its σ_next vanishes. See constraints/README.md. Cost: one factorization
// (not symmetric) and, mostly, one solve a step.
class Feedforward : public ConstraintMethod {
 public:
  struct Options {
    double tolerance = 1e-7;
    int extrapolation = 2;
    int max_solves = 20;

    std::vector<Option> describe() {
      return {{"tolerance",
               &tolerance,
               "relative bond error for which a step takes another solve",
               {.range = kTolerances}},
              {"extrapolation",
               &extrapolation,
               "order in which λ is extrapolated",
               {.range = {.min = 0, .max = 2}}},
              {"max_solves", &max_solves, "solves after which a step has failed", {.range = {.min = 1}}}};
    }
  };

  Feedforward(const System& sys, const Options& options, double /*h*/);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s);  // from λ as it is

  void serialize(Archive& archive) override { archive(lambda_, before_, before_that_, known_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::array<Eigen::VectorXd*, 3> past() { return {&lambda_, &before_, &before_that_}; }
  int& steps_known() { return known_; }
  // The default's value, said or not, promises what a thermostat that rescales velocities leaves, of which no
  // solve of its step knew; any other tolerance promises itself.
  double promised_error() const override {
    return options_.tolerance == Options{}.tolerance ? 1e-5 : options_.tolerance;
  }
  std::string setting() const override;

 private:
  void extrapolate();
  SolveStats solve(const System& sys, const Push& push, const State& s);

  Options options_;
  DirectSolver solver_;
  Vectors r_, r_next_;                             // 3 × m
  Vectors y_;                                      // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd b_;                              // m
  Eigen::VectorXd lambda_, before_, before_that_;  // of the last steps, newest first
  int known_ = 0;                                  // how many of them there are
};

}  // namespace taut
