#pragma once

#include <Eigen/Core>
#include <string_view>

namespace taut {

// Incompressible flow as a constraint: D u = 0 on a small periodic staggered grid (marker and cell: Harlow
// and Welch 1965, doi:10.1063/1.1761178), held by what holds bonds. With the cells' divergence for σ̇ and the
// volume that a cell has taken in, σ = ∫ D u dt, for σ, the constraint is linear:
//     u̇ = F(u) + Dᵀλ,   σ̈ + 2ασ̇ + β²σ = 0,   D Dᵀ λ = −(D F + 2α D u + β²σ).
// λ is the pressure with its sign changed, D Dᵀ the Laplacian with its, and nothing is quadratic. In
// leap-frog, u₊ = u₋ + h(F + Dᵀλ), the cells' σ obey constraints/methods/propagator.hpp to rounding:
//     (1 + αh)σ₊ = (2 − β²h²)σ − (1 − αh)σ₋.
// Dead-beat it is the corrective term of Hirt and Harlow (J. Comput. Phys. 2, 1967, 114), who met
// the same drift: where the pressure is found by iteration alone, what it leaves of D u̇ adds up in D u.
class Flow {
 public:
  enum class Keeps {
    kBare,      // α = β = 0: D u̇ = 0 alone
    kProjects,  // the same, then u −= Dᵀ(D Dᵀ)⁻¹ D u in every step
    kFeedsBack  // α, β
  };
  struct Options {
    int cells = 32;           // a side, of 2π
    double viscosity = 0.01;  // ν
    double h = 0.01;          // of a step
    Keeps keeps = Keeps::kFeedsBack;
    double ah = 1, bh = 1.4142135623730951;  // αh and βh: dead-beat
    double tolerance = 1e-13;                // of the pressure's residual, over that of λ = 0
  };
  using Field = Eigen::ArrayXXd;  // cells × cells, periodic

  // Sets out from the Taylor–Green vortex, u = cos x sin y, v = −sin x cos y, and `push` times a field that
  // all flows out of some cells into others.
  explicit Flow(const Options& options, double push = 0);

  void step();

  Field divergence() const { return divergence(u_, v_); }
  const Field& taken_in() const { return sigma_; }  // σ of each cell
  double time() const { return t_; }
  // rms of u and v less the vortex's e^(−2νt).
  double error() const;
  int iterations() const { return iterations_; }  // of conjugate gradients, so far

 private:
  struct Velocity {
    Field u, v;  // on the cells' left and lower sides
  };
  Field divergence(const Field& u, const Field& v) const;
  void add_gradient(double by, const Field& lambda, Field& u, Field& v) const;  // += by·Dᵀλ
  Velocity force(const Field& u, const Field& v) const;                         // F
  void solve(const Field& b, Field& lambda);                                    // D Dᵀ λ = b, from λ on

  Options options_;
  double dx_, t_ = 0;
  Field u_, v_, sigma_, lambda_, correction_;
  Velocity before_;  // F of the step before
  bool first_ = true;
  int iterations_ = 0;
};

}  // namespace taut
