#pragma once

#include <array>
#include <memory>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// The reciprocal part of Ewald's sum by smooth particle mesh Ewald (Essmann et al. 1995,
// doi:10.1063/1.470117, eqs. 4.7 and 4.8): with Q the charges on the grid, F its transform and V the volume,
//     E = ½ Σ_{m≠0} G(m) |F(m)|²,   G = exp(−π²m²/α²)/(πV m²) / |b|⁻²(m₁)|b|⁻²(m₂)|b|⁻²(m₃)
//     −dE/dstrain = ½ Σ_{m≠0} G(m) |F(m)|² (1 − 2(1/m² + π²/α²) m⊗m)   (eq. 2.7)
//     φ = the transform back of G F = dE/dQ;   f = −q Σ φ dw/dx, w the spline's weights.
// m are the vectors of the reciprocal lattice; splines and grid go along a, b and c. A wave in the middle of
// an even edge, m = ±K/2, has the mean of G over both signs: the sum over all K₁K₂K₃ waves comes to that.
//
// A plane of the grid, all its charges and its transform, is one thread's at a time; so are the transforms
// across planes of a row of it. No sum depends on how many threads there are. In mixed precision splines,
// grid and transforms are single, places, forces and sums of energies double.
class PmeMesh {
 public:
  // charge: √k q [√(kJ/mol·nm)], n; parameters as chosen. Of no box yet.
  PmeMesh(const Eigen::VectorXd& charge, const PmeParameters& parameters, Precision precision);
  ~PmeMesh();
  PmeMesh(PmeMesh&&) noexcept;
  PmeMesh& operator=(PmeMesh&&) noexcept;

  void set_box(const Box& box);                     // the grid stays, and is stretched with it
  double add_forces(const Vectors& x, Vectors& f);  // returns the energy [kJ/mol]
  // At x [kJ/mol]: charges are spread and transformed again, so that a step that does not ask does not pay.
  Eigen::Matrix3d virial(const Vectors& x);

  class Engine;  // in one of the precisions

 private:
  std::unique_ptr<Engine> engine_;
};

}  // namespace taut
