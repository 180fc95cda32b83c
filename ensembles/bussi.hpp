#pragma once

#include <cstdint>

#include "base/random.hpp"
#include "md/observables.hpp"

namespace taut {

// Stochastic velocity rescaling (Bussi, Donadio, Parrinello 2007, doi:10.1063/1.2408420): the kinetic energy
// relaxes to its canonical distribution, all velocities scaled alike, so that none leaves the bonds' tangent.
//     K' = cK + (K̄/n)(1−c) Σ R² + 2 R₁ √(c(1−c) K K̄/n),   c = exp(−h/τ),   K̄ = ½nkT,   n normal numbers R.
class VelocityRescaling {
 public:
  // temperature [K], relaxation time [ps]; dof: degrees of freedom, at least 1.
  VelocityRescaling(double temperature, double relaxation, int dof, std::uint64_t seed);

  // The velocities' kinetic energy [kJ/mol] is told: not all of it need be thermal. Returns K'/K.
  double operator()(double kinetic, double h, Vectors& v);
  void serialize(Archive& archive) { archive(random_); }

 private:
  double target_;  // ½nkT [kJ/mol]
  double relaxation_;
  int dof_;
  RandomCounter random_;
};

}  // namespace taut
