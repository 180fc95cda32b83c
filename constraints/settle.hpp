#pragma once

#include <array>
#include <string>
#include <vector>

#include "constraints/gaps.hpp"

namespace taut {

// SETTLE (Miyamoto and Kollman 1992, doi:10.1002/jcc.540130805): a rigid triangle with two equal sides and
// equal masses at their far ends (water) is put back on its shape in closed form, three rotations φ, ψ, θ
// about the axes of the triangle before the step; its velocities by the 3 × 3 system A g = −J v. Refuses any
// other cluster, naming it. Cost: per water three square roots for the axes and four for the rotations.
class Settle : public EmptyGaps {
 public:
  static constexpr const char* kName = "settle";
  static constexpr const char* kSummary = "three-site water in closed form";

  struct Options {
    void describe(auto&&) {}
  };

  struct Water {
    int apex, left, right;     // atoms
    std::array<int, 3> bonds;  // apex–left, apex–right, left–right
    double ra, rb, rc;         // apex to centre of mass, that to the base line, half the base [nm]
  };
  // Throws InputError for any bond that is not part of one.
  static std::vector<Water> find_waters(const System& sys);

  Settle(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(lambda_); }
  const Eigen::VectorXd& lambda() const { return lambda_; }
  double promised_error() const { return 1e-12; }
  std::string setting() const;

 private:
  bool reset(const Water& water, const System& sys, double h, State& s) const;

  std::vector<Water> waters_;
  Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
