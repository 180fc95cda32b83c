#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/statistics.hpp"

namespace taut {

// A distance held rigid at one length, and what a run there gives (simulation/held_bonds.hpp).
struct HeldLength {
  double length;     // d [nm]
  Estimate tension;  // τ, above 0 where the bond pulls its atoms together [kJ/mol/nm]
  Estimate weight;   // w = √μ, or d
};

// What the mean force along a distance integrates to, 0 at the longest d. Errors are those of the difference to it:
//     held = −∫⟨τ⟩dd             free energy of the system that is held: thermodynamic integration along a bond's length
//     distribution = −kT ln P(d) = held − kT ln⟨w⟩
//     potential = −kT ln(P(d)/d²) = distribution + 2kT ln d    of mean force, 0 where atoms do not act on each other
struct FreeEnergies {
  HeldLength at;
  Estimate held, distribution, potential;  // [kJ/mol]
};

// `lengths`: two or more, ascending, each once. Between two of them ⟨τ⟩ is the cubic through the four nearest, of three
// or two lengths the parabola or the line through all.
std::vector<FreeEnergies> integrate_mean_force(const std::vector<HeldLength>& lengths, double kT);

// About what the potential is off for the spacing of its lengths: what it changes by without every other length, both
// ends kept, less two standard errors of that change. Where it changed by r times as much when half of those that remain
// were left out, too, Richardson's 1/(r − 1) of it is left with all, 2 ≤ r ≤ 16 of the fourth order. None for fewer
// lengths than kLengthsToJudge, which cannot tell [kJ/mol].
constexpr std::size_t kLengthsToJudge = 5;
std::optional<double> error_of_spacing(const std::vector<HeldLength>& lengths);

}  // namespace taut
