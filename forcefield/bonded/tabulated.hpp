#pragma once

#include <array>
#include <span>

#include "forcefield/terms.hpp"

namespace taut {

// Each adds the forces to f and returns the energy [kJ/mol], one term after the other. Nothing is extrapolated: they
// throw SimulationFailure for a distance or an angle outside its table. Where the atoms of an angle are in line, its
// forces are zero.
double add_term_forces(std::span<const TabulatedBond> bonds, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const TabulatedAngle> angles, const Vectors& x, Vectors& f);

// Throws InputError where one of them is outside its table at the start.
void check_tables_cover(const System& sys, const Terms& terms, const Vectors& start);

}  // namespace taut
