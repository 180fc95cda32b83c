#pragma once

#include <cstdint>

#include "base/random.hpp"
#include "ensembles/drift_velocity.hpp"
#include "md/bath.hpp"

namespace taut {

// Stochastic velocity rescaling (Bussi, Donadio, Parrinello 2007, doi:10.1063/1.2408420): the kinetic energy
// relaxes to its canonical distribution, all velocities scaled alike.
//     K' = cK + (K̄/n)(1−c) Σ R² + 2 R₁ √(c(1−c) K K̄/n),   c = exp(−h/τ),   K̄ = ½nkT,   n normal numbers R.
//
// K is that of the velocity u of the drift ahead (ensembles/drift_velocity.hpp), and u is what is scaled,
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
  double next_scale(double kinetic, double h);  // K'/K

  Settings settings_;
  DriftVelocity drift_;
  RandomCounter random_;
};

}  // namespace taut
