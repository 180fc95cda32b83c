#pragma once

#include <cstdint>
#include <memory>

#include "base/random.hpp"
#include "md/bath.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// Stochastic velocity rescaling (Bussi, Donadio, Parrinello 2007, doi:10.1063/1.2408420): the kinetic energy
// relaxes to its canonical distribution, all velocities scaled alike.
//     K' = cK + (K̄/n)(1−c) Σ R² + 2 R₁ √(c(1−c) K K̄/n),   c = exp(−h/τ),   K̄ = ½nkT,   n normal numbers R.
//
// K is that of the drift ahead, of u = P(v + (h/2)M⁻¹f), P = 1 − M⁻¹Jᵀ A⁻¹ J the projection on the tangent space of
// the bonds: canonical for harmonic motion at any step, where v is too cold by (ωh)²/4 (docs/ensembles.md). And u is
// what is scaled,
//     v' = v + (√(K'/K) − 1) u   gives   u' = √(K'/K) u,
// so that no velocity leaves the tangent, and what a method or springs in place of bonds leave along them is no heat.
// It acts where the drift begins; beside one that acts in the drift's middle the temperature of harmonic motion is off
// by up to (ωh)²/4n of itself, the share of one degree of freedom in n.
class VelocityRescaling final : public Bath {
 public:
  struct Settings {
    double temperature;  // [K]
    double relaxation;   // [ps]
    int dof;             // n, at least 1
    std::uint64_t seed = 1;
  };
  VelocityRescaling(const System& sys, const Settings& settings);

  double after_step(const System& sys, double h, State& s) override;
  void set_temperature(double kelvin) override { settings_.temperature = kelvin; }
  void serialize(Archive& archive) override { archive(random_); }

 private:
  void find_middle_velocity(const System& sys, double h, const State& s);
  double next_scale(double kinetic, double h);  // K'/K

  Settings settings_;
  System tangent_;                               // the atoms with the bonds that turn
  std::unique_ptr<ConstraintMethod> projector_;  // whose velocities are P's
  State middle_;                                 // x, and u in the place of v
  RandomCounter random_;
};

}  // namespace taut
