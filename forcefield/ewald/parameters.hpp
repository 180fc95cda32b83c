#pragma once

#include <string>

#include "base/errors.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"

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

// By what share forces are about wrong, on the scale of the tolerance.
struct EwaldErrors {
  double pairs;  // of what the cutoff leaves out: ½exp(−α²r_c²)
  double mesh;   // of interpolation on points h apart, the coarsest direction's: (2αh/3)^order
};
// The rules above solved for δ, for parameters that are all chosen. How they go with α, cutoff and spacing is
// known: exp(−α²r_c²), Kolafa and Perram 1992, doi:10.1080/08927029208049126; (αh)^order, Deserno and Holm
// 1998, doi:10.1063/1.477415.
EwaldErrors ewald_errors(const PmeParameters& chosen, const Box& box, double cutoff);

// One line where an error is more than ten times the tolerance: which, and what to do. Else empty.
std::string doubt_of(const PmeParameters& chosen, const Box& box, double cutoff);

}  // namespace taut
