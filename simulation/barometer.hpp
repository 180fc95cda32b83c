#pragma once

#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"

namespace taut {

inline constexpr double kBarPerUnit = 16.6053906717;  // 1 kJ/mol/nm³ [bar]

// The pressure of a periodic box, all lengths scaled:
//     P = (2K + Ξ)/(3V),   Ξ = Ξ_forces + Σ λ|r|².
// The multipliers are those that hold the bonds at this very instant, A λ = −(J M⁻¹F + |v_ij|²), whatever
// method runs: right at the start as later, free of a method's lag and of a thermostat's noise. With them the
// pressure of rigid molecules is that of their centres of mass, instant by instant.
class Barometer {
 public:
  // With `springs` the bonds are a penalty's: they pull by multipliers of their own.
  explicit Barometer(const System& sys, bool springs = false);

  // Of positions x and velocities v [bar]. `spring_lambda`: only with springs.
  double operator()(const System& sys, ForceField& forces, const Vectors& x, const Vectors& v,
                    const Eigen::VectorXd& spring_lambda);

 private:
  bool springs_;
  Projector projector_;
  State now_;
};

}  // namespace taut
