#pragma once

#include <limits>
#include <optional>
#include <string>

#include "constraints/options.hpp"
#include "md/constraint_method.hpp"
#include "md/system.hpp"

namespace taut {

// Stiff springs ½k(|r| − d)² in place of rigid bonds: λ = −k(|r| − d)/|r|. There is no system to solve. The
// error of a bond is tension/k, and it oscillates with ω = √(k/μ), 1/μ = 1/m_i + 1/m_j, which the step must
// resolve.
class Penalty : public ConstraintMethod {
 public:
  struct Options {
    std::optional<double> k = {};
    double omega_h = 0.7;

    std::vector<Option> describe() {
      return {{"k",
               &k,
               "spring constant, the same for all; none: from omega_h",
               {.unit = "kJ/mol/nm²", .range = kPositive}},
              {"omega_h",
               &omega_h,
               "ωh of each bond alone, k = μ(omega_h/h)²",
               {.range = {.min = 0, .max = 2, .above_min = true, .below_max = true},
                .counts = {!k, "without method.k"}}}};
    }
  };

  Penalty(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;

  void serialize(Archive& archive) override { archive(lambda_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::string setting() const override;
  Holds holds() const override { return Holds::kSprings; }
  double spring_energy(const System& sys, const Vectors& x) const override;

 private:
  Eigen::VectorXd k_, lambda_;  // m
};

}  // namespace taut
