#pragma once

#include <optional>
#include <string>

#include "constraints/direct_solver.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// RATTLE with all bonds solved at once (matrix SHAKE: Kräutler, van Gunsteren, Hünenberger 2001,
// doi:10.1002/1096-987X(20010415)22:5<501::AID-JCC1021>3.0.CO;2-V; ILVES: López-Villellas et al. 2023,
// doi:10.1021/acs.jctc.2c01376). Positions: x += M⁻¹J(x_old)ᵀg with
//     A(x_old) Δg = −σ(x),
// a Newton iteration with the symmetric matrix of the old bond vectors in place of J(x)M⁻¹J(x_old)ᵀ. Each
// iteration reduces the error by a factor of the order of the bonds' rotation in the step. Velocities: A(x) g
// = −J v, exact. Cost: one factorization per step (that of the velocities serves the next positions), one
// solve per iteration and one for the velocities.
// Where a linkage passes a dead point, all its bars in a line, A is next to singular: one bond follows from the others
// to first order. An iteration that makes the error larger is followed by those with the exact matrix, and a bond without
// a pivot stays out of a solve. The step fails only where the error of such a bond stays.
class Newton : public ConstraintMethod {
 public:
  struct Options {
    double tolerance = 1e-10;
    int max_iterations = 50;

    std::vector<Option> describe() {
      return {{"tolerance",
               &tolerance,
               "relative bond error at which the iteration stops",
               {.range = kTolerances}},
              {"max_iterations",
               &max_iterations,
               "iterations after which a step has failed",
               {.range = {.min = 1}}}};
    }
  };

  Newton(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(lambda_, factored_, solver_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  double promised_error() const override { return options_.tolerance; }
  std::string setting() const override;

 protected:
  // Replaces b = −σ by the change of g that removes σ, 0 for a bond that depends on others. Returns false, and the
  // failure in stats, if there is none.
  virtual bool solve(Eigen::VectorXd& b, SolveStats&) {
    solver_.solve(b);
    return true;
  }
  // With A' = J(x) M⁻¹ J(x_old)ᵀ. Fails where a bond without a pivot has turned by 90°.
  bool solve_exactly(Eigen::VectorXd& b, SolveStats& stats);

  Vectors r_, r_old_;  // 3 × m, bond vectors now and before the drift

 private:
  void explain_by_pivots(bool exactly, SolveStats& stats) const;

  Options options_;
  DirectSolver solver_;
  std::optional<DirectSolver> exact_;  // of A', once it was needed
  bool factored_ = false;
  Eigen::VectorXd g_, dg_, lambda_;  // m
};

}  // namespace taut
