#pragma once

#include <array>
#include <string>

#include "constraints/direct_solver.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Feedforward: the truncation error of a Baumgarte step, which no gain removes, is known before the step and
// is corrected in advance. With the half-step velocity w and the force F at x, multipliers λ move the bonds
// to
//     δ(λ) = h w + h² M⁻¹(F + Jᵀλ),      σ_next(λ) = σ + J δ + ½|δ_ij|²      (exact, σ is quadratic).
// λ is extrapolated from previous steps and corrected by one linear solve,
//     A' Δλ = −σ_next/h²,   A' = J(x + δ) M⁻¹ J(x)ᵀ = ∂σ_next/∂λ / h²   (exact: a Newton step),
// which leaves ½|h²M⁻¹JᵀΔλ|², the square of the extrapolation's error. This remainder is the σ of the next
// step, where it is fed back as by a Baumgarte law with (βh)² = 2, αh = 1. It removes energy in proportion to
// h¹¹ (README.md, "feedforward"); at the default tolerance that is negligible. If ½(σ_next/(r_next·r))²
// before the solve exceeds `tolerance` (for a single bond this is the remainder over d²), as in large steps
// and collisions, the step takes another solve; stats.iterations counts them. Velocities are leap-frog's mean
// velocities, J v = −½h² v·a, and are not projected. At the start λ is iterated until σ_next vanishes. Cost:
// one unsymmetric factorization and, mostly, one solve per step.
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
  SolveStats again(const System& sys, const Push& push, State& s);  // starts from lambda()

  void serialize(Archive& archive) override {
    archive(lambda_, before_, before_that_, known_);
    archive.demand(0 <= known_ && known_ <= 3);
  }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::array<Eigen::VectorXd*, 3> past() { return {&lambda_, &before_, &before_that_}; }
  int& steps_known() { return known_; }
  // The default tolerance promises 1e-5, the error that a thermostat leaves when it rescales velocities after
  // the solve; any other tolerance promises itself.
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
  Eigen::VectorXd lambda_, before_, before_that_;  // m, of the last three steps, newest first
  int known_ = 0;                                  // how many of the three are known
};

}  // namespace taut
