#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "constraints/direct_solver.hpp"
#include "constraints/methods/gains.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Baumgarte's stabilization (1972, doi:10.1016/0045-7825(72)90018-7) asks of a bond's error σ̈ + 2ασ̇ + β²σ = 0.
// With both rates as differences over a step, (σ₊ − 2σ + σ₋)/h² and (σ₊ − σ₋)/2h, the law is
//     σ₊ = τ,    τ = [(2 − β²h²) σ − (1 − αh) σ₋]/(1 + αh),    σ₋ = σ(r − h v_half).
// It is solved as a position constraint is, with nothing linearised in time. Multipliers λ move the bonds to
//     r₊(λ) = r + h v_half + h² (M⁻¹(F + Jᵀλ))_ij,     σ₊(λ) = ½(|r₊|² − d²),
// λ is extrapolated from the previous steps and corrected by a Newton step with the exact derivative,
//     A' Δλ = −(σ₊ − τ)/h²,    A' = J(x₊) M⁻¹ J(x)ᵀ,
// which leaves ½|h²M⁻¹JᵀΔλ|², the square of what the extrapolation missed. The remainder is an error like any
// other: the law takes it away in the next steps. If ½((σ₊ − τ)/(r₊·r))² before the solve exceeds `tolerance` (for
// a single bond this is the remainder over d²), as in large steps and collisions, the step takes another solve.
// A bond without a pivot, as one of a linkage's has where all its bars come into a line, stays out of the solve; the
// step then ends when every |(σ₊ − τ)/(r₊·r)| is within the tolerance, or fails.
// README.md derives the law, its roots and limits (propagator.hpp), and what the remainder does to the energy.
//
// With αh = 1, (βh)² = 2 ("dead-beat") τ is 0: this is the method `feedforward`. Velocities are leap-frog's mean
// velocities, J v = −½h² v·a, and are not projected. At the start nothing moves along a bond, and σ₊ is
// (1 − ½β²h²)σ. Cost: one unsymmetric factorization and, mostly, one solve a step.
//
// `damping` other than discrete adds to τ what the textbooks' forms of the law leave out (propagator.hpp, Drive).
// With `sweeps` > 0 nothing is factored: so many Gauss–Seidel sweeps over σ₊ = τ start from the extrapolated λ,
// as in rigid-body engines, and σ feeds what they leave back in the next step.
//
// A one-sided bond (s = 1 for a strut, −1 for a rope) keeps sσ₊ ≥ 0 with sλ ≥ 0 and λσ₊ = 0: the law at dead-beat
// as an inequality. All bonds are then solved by sweeps that clip its λ (projected Gauss–Seidel), until the conditions
// hold to the tolerance. Without gains (`none`) a one-sided bond demands only s(σ₊ − 2σ + σ₋) ≥ 0 once sσ ≤ 0.
class Baumgarte : public ConstraintMethod {
 public:
  struct Options {
    std::string gains = "reversible";
    std::string damping = "discrete";
    std::optional<double> alpha_per_ps = {}, beta_per_ps = {}, reduction = {};
    double stiffness = 4.5e5;
    int sweeps = 0;
    double tolerance = 1e-7;
    int extrapolation = 2;
    int max_solves = 20;

    std::vector<Option> describe();
    GainChoice choice() const {
      return {.name = gains,
              .alpha_per_ps = alpha_per_ps,
              .beta_per_ps = beta_per_ps,
              .reduction = reduction.value_or(0),
              .stiffness = stiffness};
    }
    // Whether the kernels in lanes solve it: textbooks' laws and sweeps have the plain form alone.
    bool in_lanes() const { return sweeps == 0 && damping == "discrete" && gains != "hoomd"; }
  };

  Baumgarte(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s);  // starts from lambda()

  void serialize(Archive& archive) override {
    archive(lambda_, before_, before_that_, known_);
    archive.demand(0 <= known_ && known_ <= 3);
  }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::array<Eigen::VectorXd*, 3> past() { return {&lambda_, &before_, &before_that_}; }
  int& steps_known() { return known_; }
  double promised_error() const override { return promised_; }
  std::string setting() const override { return setting_; }

 private:
  void extrapolate();
  SolveStats set_targets(const System& sys, const Push& push, const State& s);
  double miss(const System& sys, const Push& push, int k);
  bool is_near(double off) const;
  bool is_driven() const;
  bool has_turned() const;
  SolveStats solve(const System& sys, const Push& push, SolveStats stats);
  SolveStats solve_by_sweeps(const System& sys, const Push& push, SolveStats stats);

  Options options_;
  std::vector<Gains> gains_;  // m
  std::vector<Law> laws_;     // m, in steps of h_of_laws_
  double h_of_laws_;
  int two_sided_;
  DirectSolver solver_;
  Vectors r_, free_, a_, v_half_, r_next_;         // 3 × m; free_: r₊ without Jᵀλ; a_: (M⁻¹F)_ij
  Vectors y_;                                      // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd target_;                         // m, τ without its drive
  Eigen::VectorXd b_;                              // m
  Eigen::VectorXd lambda_, before_, before_that_;  // m, of the last three steps, newest first
  int known_ = 0;                                  // how many of the three are known
  bool corrects_;
  double promised_;
  bool by_sweeps_;  // in place of a factorization
  std::string setting_;
};

// The same law with dead-beat gains, under a name of its own.
struct Feedforward {
  struct Options {
    double tolerance = 1e-7;
    int extrapolation = 2;
    int max_solves = 20;

    std::vector<Option> describe();
    operator Baumgarte::Options() const {
      return {.gains = "dead-beat",
              .tolerance = tolerance,
              .extrapolation = extrapolation,
              .max_solves = max_solves};
    }
  };
};

// Returns gains, law and accuracy in one line.
std::string describe_baumgarte(const Baumgarte::Options& options, const std::vector<Gains>& gains, double h);

// Returns the largest |σ|/d² that a run should have: the tolerance, or, for the default, 1e-5, the error that a
// thermostat leaves when it rescales velocities after the solve; times the most that the law makes of what it is
// fed in each step. Infinite for laws with a drive, for sweeps and without gains.
double promised_error_of(const Baumgarte::Options& options, const std::vector<Law>& laws);

}  // namespace taut
