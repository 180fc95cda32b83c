#pragma once

#include <limits>
#include <optional>
#include <string>

#include "constraints/counts.hpp"
#include "constraints/gaps.hpp"
#include "md/system.hpp"

namespace taut {

// Stiff springs ½k(|r| − d)² in place of rigid bonds: λ = −k(|r| − d)/|r|. No solve at all; the bond is
// wrong by tension/k and swings at ω = √(k/μ), 1/μ = 1/m_i + 1/m_j, which the step must resolve.
class Penalty : public EmptyGaps {
 public:
  static constexpr const char* kName = "penalty";
  static constexpr const char* kSummary = "stiff springs in place of rigid bonds";

  struct Options {
    std::optional<double> k = {};
    double omega_h = 0.7;

    void describe(auto&& visit) {
      visit("k", k, "spring constant [kJ/mol/nm²], the same for all; none: from omega_h");
      visit("omega_h", omega_h, "ωh of each bond alone, k = μ(omega_h/h)²", Counts{!k, "without method.k"});
    }
  };

  Penalty(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(lambda_); }
  const Eigen::VectorXd& lambda() const { return lambda_; }
  double promised_error() const { return std::numeric_limits<double>::infinity(); }
  std::string setting() const;
  double spring_energy(const System& sys, const Vectors& x) const;  // [kJ/mol]

 private:
  Eigen::VectorXd k_, lambda_;  // m
};

}  // namespace taut
