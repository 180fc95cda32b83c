#pragma once

#include <string>

#include "constraints/methods/sweeps.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// SHAKE (Ryckaert, Ciccotti, Berendsen 1977, doi:10.1016/0021-9991(77)90098-5) in velocity Verlet: only the
// positions are corrected. The correction of the next step acts along the same J(x)ᵀ as RATTLE's correction
// of the velocities would, so that the positions are RATTLE's to tolerance. The velocities at full steps are
// not: they keep a component along the bonds, up to (h/2) M⁻¹Jᵀλ. Multipliers: δx = h² M⁻¹J(x_old)ᵀλ, so λ
// belongs to the positions before the step.
class Shake : public ConstraintMethod {
 public:
  struct Options : SweepLimits {};

  Shake(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(g_, lambda_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  double promised_error() const override { return options_.promised_error(); }
  std::string setting() const override { return options_.setting(); }
  Holds holds() const override { return Holds::kPositions; }

 private:
  Options options_;
  PositionSweeps positions_;
  Eigen::VectorXd g_, lambda_;  // m
};

}  // namespace taut
