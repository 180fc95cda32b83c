#pragma once

#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"
#include "md/units.hpp"

namespace taut {

// The pressure of a periodic box, atoms and box strained alike:
//     P = (Σ m v⊗v + Ξ)/V,   Ξ = Ξ_forces + Σ λ r⊗r,
// whose trace is three times the scalar pressure.
// The multipliers are those that hold the bonds at this very instant, A λ = −(J M⁻¹F + |v_ij|²), whatever
// method runs: right at the start as later, free of a method's lag and of a thermostat's noise. With them the
// pressure of rigid molecules is that of their centres of mass, instant by instant.
class Barometer {
 public:
  // With `springs` the bonds are a penalty's: they pull by multipliers of their own.
  explicit Barometer(const System& sys, bool springs = false);

  // The tensor [bar] of a state whose forces are all but the constraints'; evaluating them gave `besides`.
  // `spring_lambda`: only with springs.
  Eigen::Matrix3d pressure(const System& sys, ForceField& forces, const State& at,
                           const ForceField::Evaluation& besides, const Eigen::VectorXd& spring_lambda);

 private:
  bool springs_;
  Projector projector_;
};

}  // namespace taut
