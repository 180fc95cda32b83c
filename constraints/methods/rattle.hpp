#pragma once

#include <string>

#include "constraints/methods/sweeps.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// RATTLE (Andersen 1983, doi:10.1016/0021-9991(83)90014-1): sweeps correct the positions as in SHAKE, then
// remove the velocities along the bonds:
//     δx = (h²/2) M⁻¹J(x_old)ᵀλ_x,   δv = δx/h,   then δv = (h/2) M⁻¹Jᵀλ_v.
// Both multipliers estimate the same force at the same positions, so each solution starts from the other
// (warm start).
class Rattle : public ConstraintMethod {
 public:
  struct Options : SweepLimits {
    bool warm_start = true;

    std::vector<Option> describe() {
      std::vector<Option> options = SweepLimits::describe();
      options.push_back({"warm_start", &warm_start, "set out from the last multipliers"});
      return options;
    }
  };

  Rattle(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(lambda_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  double promised_error() const override { return options_.promised_error(); }
  std::string setting() const override;

 private:
  Options options_;
  PositionSweeps positions_;
  VelocitySweeps velocities_;
  Eigen::VectorXd g_, lambda_;  // m
};

}  // namespace taut
