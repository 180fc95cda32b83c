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
// Threads share out the planes of the grid for spreading and transforms within planes, and the rows for
// transforms across planes. No sum depends on the number of threads. In mixed precision splines, grid and
// transforms are in single precision; positions, forces and sums of energies are in double.
class PmeMesh {
 public:
  // charge: √k q [√(kJ/mol·nm)], n; parameters as chosen. set_box() must follow.
  PmeMesh(const Eigen::VectorXd& charge, const PmeParameters& parameters, Precision precision);
  ~PmeMesh();
  PmeMesh(PmeMesh&&) noexcept;
  PmeMesh& operator=(PmeMesh&&) noexcept;

  void set_box(const Box& box);                     // the grid stays, and is stretched with it
  double add_forces(const Vectors& x, Vectors& f);  // returns the energy [kJ/mol]
  // The virial at x [kJ/mol]. Charges are spread and transformed again, so that a step without it does not
  // pay.
  Eigen::Matrix3d virial(const Vectors& x);

  class Engine;  // one for each precision

 private:
  std::unique_ptr<Engine> engine_;
};

}  // namespace taut
