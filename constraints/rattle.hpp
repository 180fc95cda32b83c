#pragma once

#include <limits>
#include <string>

#include "constraints/counts.hpp"
#include "constraints/gaps.hpp"
#include "constraints/sweeps.hpp"

namespace taut {

// RATTLE (Andersen 1983, doi:10.1016/0021-9991(83)90014-1): SHAKE for the positions, then the velocities'
// part along the bonds taken out, sweep by sweep, in all
//     δx = (h²/2) M⁻¹J(x_old)ᵀλ_x,   δv = δx/h,   then δv = (h/2) M⁻¹Jᵀλ_v.
// Both multipliers estimate the same force at the same positions, one step apart in order of solution:
// each sets out from the other (warm start).
class Rattle : public EmptyGaps {
 public:
  static constexpr const char* kName = "rattle";
  static constexpr const char* kSummary = "sweeps over the bonds, positions and velocities";

  struct Options {
    double tolerance = 1e-10;
    int max_sweeps = 1000;
    int sweeps = 0;
    bool warm_start = true;

    void describe(auto&& visit) {
      const Counts to_tolerance{sweeps == 0, "without method.sweeps"};
      visit("tolerance", tolerance, "relative bond error, and |r·v|h/d², at which sweeps stop", to_tolerance);
      visit("max_sweeps", max_sweeps, "sweeps after which a step has failed", to_tolerance);
      visit("sweeps", sweeps, "more than 0: take just so many, whatever they leave");
      visit("warm_start", warm_start, "set out from the last multipliers");
    }
  };

  Rattle(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(lambda_); }
  const Eigen::VectorXd& lambda() const { return lambda_; }
  double promised_error() const {
    return options_.sweeps > 0 ? std::numeric_limits<double>::infinity() : options_.tolerance;
  }
  std::string setting() const;

 private:
  Options options_;
  PositionSweeps positions_;
  VelocitySweeps velocities_;
  Eigen::VectorXd g_, lambda_;  // m
};

}  // namespace taut
