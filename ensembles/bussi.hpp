#pragma once

#include <cstdint>
#include <optional>

#include "base/random.hpp"
#include "constraints/projection.hpp"
#include "md/bath.hpp"

namespace taut {

// Stochastic velocity rescaling (Bussi, Donadio, Parrinello 2007, doi:10.1063/1.2408420): the kinetic energy
// relaxes to its canonical distribution, all velocities scaled alike, so that none leaves the bonds' tangent.
//     K' = cK + (K̄/n)(1−c) Σ R² + 2 R₁ √(c(1−c) K K̄/n),   c = exp(−h/τ),   K̄ = ½nkT,   n normal numbers R.
//
// A method that leaves velocities along the bonds, or springs in place of bonds, has a kinetic energy that is
// not thermal: the scale follows from what is left without it.
class VelocityRescaling final : public Bath {
 public:
  struct Settings {
    double temperature;  // [K]
    double relaxation;   // [ps]
    int dof;             // degrees of freedom, at least 1
    std::uint64_t seed = 1;
    ConstraintMethod::Holds holds = ConstraintMethod::Holds::kAll;
  };
  VelocityRescaling(const System& sys, const Settings& settings);

  double after_step(const System& sys, double h, State& s) override;
  void set_temperature(double kelvin) override { settings_.temperature = kelvin; }
  void serialize(Archive& archive) override { archive(random_); }

 private:
  Settings settings_;
  std::optional<Projector> projector_;  // where not all of the kinetic energy is thermal
  RandomCounter random_;
};

}  // namespace taut
