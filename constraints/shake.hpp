#pragma once

#include <limits>
#include <string>

#include "constraints/counts.hpp"
#include "constraints/gaps.hpp"
#include "constraints/sweeps.hpp"

namespace taut {

// SHAKE (Ryckaert, Ciccotti, Berendsen 1977, doi:10.1016/0021-9991(77)90098-5) in velocity Verlet: the
// positions alone are corrected. What RATTLE would take from the velocity along the bonds, J(x)ᵀ, is taken by
// the next step's correction, which acts along the same J(x)ᵀ: the positions are RATTLE's, to tolerance.
// The velocities at full steps are not: they keep a part along the bonds, up to (h/2) M⁻¹Jᵀλ.
// Multipliers: δx = h² M⁻¹J(x_old)ᵀλ, so λ belongs to the positions before the step.
class Shake : public EmptyGaps {
 public:
  static constexpr const char* kName = "shake";
  static constexpr const char* kSummary = "sweeps over the bonds, positions only";

  struct Options {
    double tolerance = 1e-10;
    int max_sweeps = 1000;
    int sweeps = 0;

    void describe(auto&& visit) {
      const Counts to_tolerance{sweeps == 0, "without method.sweeps"};
      visit("tolerance", tolerance, "relative bond error at which sweeps stop", to_tolerance);
      visit("max_sweeps", max_sweeps, "sweeps after which a step has failed", to_tolerance);
      visit("sweeps", sweeps, "more than 0: take just so many, whatever they leave");
    }
  };

  Shake(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(g_, lambda_); }
  const Eigen::VectorXd& lambda() const { return lambda_; }
  double promised_error() const {
    return options_.sweeps > 0 ? std::numeric_limits<double>::infinity() : options_.tolerance;
  }
  std::string setting() const;

 private:
  Options options_;
  PositionSweeps positions_;
  Eigen::VectorXd g_, lambda_;  // m
};

}  // namespace taut
