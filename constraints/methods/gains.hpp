#pragma once

#include <optional>
#include <string>
#include <vector>

#include "constraints/methods/propagator.hpp"
#include "md/system.hpp"

namespace taut {

// σ̈ + 2ασ̇ + β²σ = 0
struct Gains {
  double alpha = 0;  // [1/ps]
  double beta = 0;   // [1/ps]
};

// How Baumgarte's gains are chosen: by name, for a step h.
// clang-format off
//   reversible  αh = 0.3, (βh)² = 2.5 (0.1 and 2 where damping is not discrete): weakly damped, nearly time-reversible
//   dead-beat   both roots 0: an error is gone in two steps, as under a converged RATTLE
//   hoomd       the same: what HOOMD-blue's distance constraints come to. Their condition, linear in the acceleration,
//               σ/h² + σ̇_half/h + ½|v_half|² + (r + h v_half)·a = 0 (Yoneya 2001, doi:10.1006/jcph.2001.6718), is in the
//               end velocity's σ̇ the centred law with −¾h²|a|², the discrete one with −h²|a|²: it leaves
//               σ₊ = ½h⁴|a|²
//   rattle      roots `reduction` and 0: an error shrinks by `reduction` a step, as RATTLE does (taut calibrate)
//   swept       a pair of roots of modulus `reduction`: what a fixed number of sweeps of RATTLE's does to an error of
//               which they leave that share (taut calibrate --copies slowest)
//   critical    α = β = 1/h
//   physical    α = β = √(stiffness/μ), the bond as the real one swings, critically damped; capped, where the
//               step cannot bear it, at βh = 1.9
//   box2d       β = 2π·¼/h, α = 2β: a spring of a quarter of the step's frequency, to which Box2D 3.1 clamps its
//               contacts, with the damping ratio of its joints, 2 (joints it clamps to an eighth)
//   numbers     alpha_per_ps and beta_per_ps as given
// clang-format on
// A given α or β stands in place of the named one.
struct GainChoice {
  std::string name = "reversible";
  std::optional<double> alpha_per_ps = {}, beta_per_ps = {};  // [1/ps]
  double reduction = 0;                                       // of an error a step, for "rattle" and "swept"
  double stiffness = 4.5e5;                                   // of a real bond, for "physical" [kJ/mol/nm²]
};

std::vector<std::string_view> gain_names();

// A bond's gains each. Throws InputError for an unknown name, missing numbers, or gains the step cannot bear.
std::vector<Gains> choose_gains(const GainChoice& choice, Damping damping, const System& sys, double h);

}  // namespace taut
