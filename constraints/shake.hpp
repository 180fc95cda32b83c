#pragma once

#include <limits>
#include <string>

#include "constraints/options.hpp"
#include "constraints/sweeps.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// SHAKE (Ryckaert, Ciccotti, Berendsen 1977, doi:10.1016/0021-9991(77)90098-5) in velocity Verlet: the
// positions alone are corrected. What RATTLE would take from the velocity along the bonds, J(x)ᵀ, is taken by
// the next step's correction, which acts along the same J(x)ᵀ: the positions are RATTLE's, to tolerance.
// The velocities at full steps are not: they keep a part along the bonds, up to (h/2) M⁻¹Jᵀλ.
// Multipliers: δx = h² M⁻¹J(x_old)ᵀλ, so λ belongs to the positions before the step.
class Shake : public ConstraintMethod {
 public:
  struct Options {
    double tolerance = 1e-10;
    int max_sweeps = 1000;
    int sweeps = 0;

    std::vector<Option> describe() {
      const Counts to_tolerance{sweeps == 0, "without method.sweeps"};
      return {
          {"tolerance",
           &tolerance,
           "relative bond error at which sweeps stop",
           {.range = kTolerances, .counts = to_tolerance}},
          {"max_sweeps",
           &max_sweeps,
           "sweeps after which a step has failed",
           {.range = {.min = 1}, .counts = to_tolerance}},
          {"sweeps", &sweeps, "more than 0: take just so many, whatever they leave", {.range = {.min = 0}}}};
    }
  };

  Shake(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(g_, lambda_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  double promised_error() const override {
    return options_.sweeps > 0 ? std::numeric_limits<double>::infinity() : options_.tolerance;
  }
  std::string setting() const override;
  Holds holds() const override { return Holds::kPositions; }

 private:
  Options options_;
  PositionSweeps positions_;
  Eigen::VectorXd g_, lambda_;  // m
};

}  // namespace taut
