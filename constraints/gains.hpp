#pragma once

#include <optional>
#include <string>
#include <vector>

#include "constraints/propagator.hpp"
#include "md/system.hpp"

namespace taut {

// σ̈ + 2ασ̇ + β²σ = 0
struct Gains {
  double alpha = 0;  // [1/ps]
  double beta = 0;   // [1/ps]
};

// How Baumgarte's gains are chosen: by name, for a step h.
//   reversible   αh = 0.1, (βh)² = 2: weakly damped; with centred damping nearly time-reversible, keeps energy
//   dead-beat    both roots 0: an error is gone in two steps, as under a converged RATTLE.
//                Also what HOOMD-blue's distance constraints come to: their |r + h v_half + h²a|² = d²,
//                linear in a (hoomd/md/ForceDistanceConstraint.cc), is α = 1/h, β² = 2/h² with part of the
//                truncation kept
//   rattle       roots `reduction` and 0: an error shrinks by `reduction` a step, as RATTLE does (taut
//   calibrate) critical     α = β = 1/h physical     α = β = √(stiffness/μ), the bond as the real one swings,
//   critically damped; capped, where the
//                step cannot bear it, at βh = 1.9
//   box2d        β = 2π·¼/h, α = 2β: Box2D 3.1's joint softness (60 Hz, damping ratio 2) where its clamp of a
//   quarter of
//                the step's frequency holds
//   numbers      alpha_per_ps and beta_per_ps as given
// A given α or β stands in place of the named one.
struct GainChoice {
  std::string name = "reversible";
  std::optional<double> alpha_per_ps = {}, beta_per_ps = {};  // [1/ps]
  double reduction = 0;                                       // of an error a step, for "rattle"
  double stiffness = 4.5e5;                                   // of a real bond, for "physical" [kJ/mol/nm²]
};

// A bond's gains each. Throws InputError for an unknown name, missing numbers, or gains the step cannot bear.
std::vector<Gains> choose_gains(const GainChoice& choice, Damping damping, const System& sys, double h);

}  // namespace taut
