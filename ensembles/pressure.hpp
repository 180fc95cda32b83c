#pragma once

#include "forcefield/force_field.hpp"
#include "md/units.hpp"

namespace taut {

// The pressure's tensor of a periodic box, atoms and box strained alike [bar]:
//     P = (Σ m v⊗v + Ξ)/V,   Ξ = Ξ_forces + Σ λ r⊗r,
// whose trace is three times the scalar pressure. It is of a state whose forces are all but the constraints';
// evaluating them gave `evaluation`.
// The multipliers are a penalty's, of its springs, or those that hold the bonds at this very instant,
// A λ = −(J M⁻¹F + |v_ij|²), whatever method runs: right at the start as later, free of a method's lag and of a
// thermostat's noise. With them the pressure of rigid molecules is that of their centres of mass, instant by instant.
Eigen::Matrix3d pressure(const System& sys, ForceField& forces, const State& at,
                         const ForceField::Evaluation& evaluation, const Eigen::VectorXd& lambda);

}  // namespace taut
