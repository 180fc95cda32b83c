#pragma once

#include <vector>

#include "forcefield/terms.hpp"

namespace taut {

// Forces between atoms that are neighbours along a molecule. Each adds its forces to f and returns its
// energy [kJ/mol]. Molecules are whole in x, so separations are plain differences (no images).
//
// These are the plain loops, to read and to hold others against; a step goes by bonded_forces.hpp.

double add_bonds(const std::vector<HarmonicBond>& bonds, const Vectors& x, Vectors& f);
double add_angles(const std::vector<HarmonicAngle>& angles, const Vectors& x, Vectors& f);
double add_torsions(const std::vector<PeriodicTorsion>& torsions, const Vectors& x, Vectors& f);
double add_rb_torsions(const std::vector<RyckaertBellemans>& torsions, const Vectors& x, Vectors& f);
double add_harmonic_torsions(const std::vector<HarmonicTorsion>& torsions, const Vectors& x, Vectors& f);
// Throws SimulationFailure where a bond is stretched to r₀ or more.
double add_fene(const std::vector<Fene>& bonds, const Vectors& x, Vectors& f);
[[noreturn]] void throw_broken(const std::vector<Fene>& bonds, const Vectors& x);  // names the worst

}  // namespace taut
