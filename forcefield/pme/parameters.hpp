#pragma once

#include <string>

#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/errors.hpp"

namespace taut {

inline constexpr int kLeastOrder = 4, kMostOrder = 8;  // of the splines

// Which parameter no sum can be made of.
struct PmeError : InputError {
  enum Parameter { kOrder, kTolerance, kAlpha, kGrid };
  PmeError(Parameter is_wrong, const std::string& message) : InputError(message), wrong(is_wrong) {}
  Parameter wrong;
};

// What of α and grid is not given, from the tolerance δ, as OpenMM chooses it:
//     α = √(−ln 2δ)/r_c,   K = ⌈2αL/(3δ^⅕)⌉ along an edge L, at least 6
// and from there up to the next K = 2ᵃ3ᵇ5ᶜ7ᵈ, which transforms fast. OpenMM takes a grid it is given as it
// is; so does taut. Throws PmeError for what no sum can be made of.
PmeParameters chosen_parameters(const PmeParameters& given, const Box& box, double cutoff);

}  // namespace taut
