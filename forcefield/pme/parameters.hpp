#pragma once

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

inline constexpr int kLeastOrder = 4, kMostOrder = 8;  // of the splines

// What of α and grid is not given, from the tolerance δ, as OpenMM chooses it:
//     α = √(−ln 2δ)/r_c,   K = ⌈2αL/(3δ^⅕)⌉ along an edge L, at least 6
// and from there up to the next K = 2ᵃ3ᵇ5ᶜ7ᵈ, which transforms fast. OpenMM takes a grid it is given as it
// is; so does taut. Throws InputError for what no sum can be made of.
PmeParameters chosen_parameters(const PmeParameters& given, const Box& box, double cutoff);

}  // namespace taut
