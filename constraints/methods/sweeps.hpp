#pragma once

#include <string>
#include <vector>

#include "constraints/options.hpp"
#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// One bond after the other, again and again until all hold: what SHAKE and RATTLE share.

struct SweepLimits {
  double tolerance = 1e-10;  // relative error of a bond length at which the sweeps stop
  int max_sweeps = 1000;     // after which they have failed
  int sweeps = 0;            // more than 0: take just so many and accept what they leave

  std::vector<Option> describe();
  double promised_error() const;
  std::string setting() const;
};

// Positions (Ryckaert, Ciccotti, Berendsen 1977, doi:10.1016/0021-9991(77)90098-5): x += M⁻¹J(x_old)ᵀ g,
// v by the same over h, g found bond by bond from
//     σ + g (1/m_i + 1/m_j) r_old·r = 0.
// Stops where every |σ|/d² ≤ tolerance, or after so many sweeps as asked for. Fails where a bond has turned
// by 90° within the step (r_old·r ≤ 0, no g along r_old can mend it), or sweeps run out.
// The g of a one-sided bond stays on its side (projected Gauss–Seidel: Jourdan, Alart, Jean 1998,
// doi:10.1016/S0045-7825(97)00137-0): a strut that has g = 0 and σ ≥ 0 is slack.
class PositionSweeps {
 public:
  PositionSweeps(const System& sys, SweepLimits limits);

  // g_ holds the first guess and returns what was used; x is drifted by h·v.
  SolveStats run(const System& sys, double h, State& s, Eigen::VectorXd& g);

 private:
  SweepLimits limits_;
  Vectors r_old_;  // 3 × m
};

// Velocities (Andersen 1983, doi:10.1016/0021-9991(83)90014-1): v += M⁻¹Jᵀ g with r·v_ij = 0 on every bond.
// Stops where every |r·v_ij| h/d² ≤ tolerance: what the bond would stretch in one step, relatively.
// One-sided bonds that held the positions (whose λ there is not 0) keep their atoms from coming on, and let
// them part: a touch takes the velocity along the bond, which is Newton's law of impact without rebound
// (Moreau 1988, doi:10.1007/978-3-7091-2624-0_1), and never makes energy (constraints/README.md).
class VelocitySweeps {
 public:
  VelocitySweeps(const System& sys, SweepLimits limits);

  // held: λ of the positions.
  SolveStats run(const System& sys, double h, State& s, const Eigen::VectorXd& held, Eigen::VectorXd& g);

 private:
  SweepLimits limits_;
  Vectors r_;            // 3 × m
  Eigen::VectorXd inv_;  // 1/((1/m_i + 1/m_j)|r|²), m
};

}  // namespace taut
