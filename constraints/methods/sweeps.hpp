#pragma once

#include <string>
#include <vector>

#include "constraints/options.hpp"
#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Gauss–Seidel sweeps, which SHAKE and RATTLE share: correct one bond after the other until all are within
// tolerance.

struct SweepLimits {
  double tolerance = 1e-10;  // largest relative error of a bond length
  int max_sweeps = 1000;     // the step fails after this many
  int sweeps = 0;            // if more than 0: exactly so many sweeps, whatever error remains

  std::vector<Option> describe();
  double promised_error() const;
  std::string setting() const;
};

// Corrects positions (Ryckaert, Ciccotti, Berendsen 1977, doi:10.1016/0021-9991(77)90098-5): x +=
// M⁻¹J(x_old)ᵀ g and v by the same over h, with g found bond by bond from
//     σ + g (1/m_i + 1/m_j) r_old·r = 0.
// Stops when every |σ|/d² ≤ tolerance, or after the requested number of sweeps. Fails if a bond has turned by
// 90° within the step (r_old·r ≤ 0: no g along r_old restores it), or after max_sweeps. The g of a one-sided
// bond is clipped to its sign (projected Gauss–Seidel: Jourdan, Alart, Jean 1998,
// doi:10.1016/S0045-7825(97)00137-0); a strut with g = 0 and σ ≥ 0 is slack.
class PositionSweeps {
 public:
  PositionSweeps(const System& sys, SweepLimits limits);

  // On entry x has drifted by h·v and g is the first guess; on return g is the solution.
  SolveStats run(const System& sys, double h, State& s, Eigen::VectorXd& g);

 private:
  SweepLimits limits_;
  Vectors r_old_;  // 3 × m
};

// Corrects velocities (Andersen 1983, doi:10.1016/0021-9991(83)90014-1): v += M⁻¹Jᵀ g with r·v_ij = 0 on
// every bond. Stops when every |r·v_ij| h/d² ≤ tolerance, the relative stretch of the bond in one step.
// One-sided bonds that acted on the positions (λ ≠ 0) stop the approach of their atoms but let them part:
// Newton's law of impact with restitution 0 (Moreau 1988, doi:10.1007/978-3-7091-2624-0_1), which never adds
// energy (constraints/README.md).
class VelocitySweeps {
 public:
  VelocitySweeps(const System& sys, SweepLimits limits);

  // held: λ of the positions, m.
  SolveStats run(const System& sys, double h, State& s, const Eigen::VectorXd& held, Eigen::VectorXd& g);

 private:
  SweepLimits limits_;
  Vectors r_;                 // 3 × m
  Eigen::VectorXd inv_a_kk_;  // 1/((1/m_i + 1/m_j)|r|²), m
};

}  // namespace taut
