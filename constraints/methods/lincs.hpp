#pragma once

#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "constraints/direct_solver.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Finds triangles of bonds: two bonds that share an atom and whose other ends a third bond joins.
class BondTriangles {
 public:
  explicit BondTriangles(const std::vector<RigidBond>& bonds);
  bool hold(const RigidBond& k, const RigidBond& l) const;

 private:
  std::set<std::pair<int, int>> tied_;  // atoms, the smaller first
};

// LINCS (Hess, Bekker, Berendsen, Fraaije 1997,
// doi:10.1002/(SICI)1096-987X(199709)18:12<1463::AID-JCC4>3.0.CO;2-H): with B the directions of the bonds
// before the step and S = diag(1/m_i + 1/m_j)^−½,
//     x ← x − M⁻¹BᵀS (I − C)⁻¹ S(B x − d),   C = I − S B M⁻¹Bᵀ S,
// where the inverse is expanded in powers of C up to `order`. Then `iterations` corrections for the
// lengthening of the bonds by rotation take d − √(2d² − |r|²) in place of B x − d. Velocities are projected
// the same way, without correction, as with GROMACS's md-vv integrator. The expansion converges where C's
// eigenvalues are below 1: fast for bonds alone (about 0.4), slowly in triangles (about 0.7). As in GROMACS,
// bonds in triangles therefore take as many powers again, with the couplings T inside triangles alone:
//     (I − C)⁻¹ ≈ 1 + C + … + C^order + (T + … + T^order) C^order.
// Differs from the paper: double precision; no warning angle, the remaining error is reported. Cost: an
// application is order + 1 products with C, and order products with T if there are triangles; positions take
// 1 + iterations applications, velocities one.
class Lincs : public ConstraintMethod {
 public:
  struct Options {
    int order = 4;
    int iterations = 1;

    std::vector<Option> describe() {
      return {{"order", &order, "highest power in the expansion", {.range = {.min = 0}}},
              {"iterations", &iterations, "corrections for the bonds' turning", {.range = {.min = 0}}}};
    }
  };

  Lincs(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(lambda_); }
  const Eigen::VectorXd& lambda() const override { return lambda_; }
  std::string setting() const override;

 private:
  // power = C·rhs with the first `entries` couplings; sum += power; rhs = power
  void multiply(Eigen::Index entries);
  void find_coupling();                       // C from directions_
  void apply(const System& sys, Vectors& y);  // y −= M⁻¹BᵀS (I − C)⁻¹ rhs, and g_ += its multipliers
  void find_lambda(const System& sys, double by);

  Options options_;
  Couplings couplings_;                             // those inside triangles first
  Eigen::Index in_triangles_;                       // how many
  Vectors directions_;                              // B, 3 × m
  Eigen::VectorXd scale_;                           // S, m [√u]
  Eigen::VectorXd c_;                               // C's entries, one for each of couplings_.pairs
  Eigen::VectorXd rhs_, sum_, power_, g_, lambda_;  // m
};

}  // namespace taut
