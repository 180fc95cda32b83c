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

// How Baumgarte's gains are chosen for a step h. The names are:
//   reversible  αh = 0.3, (βh)² = 2.5 (0.1 and 2 where damping is not discrete): weakly damped, nearly
//               time-reversible
//   dead-beat   both roots 0: an error vanishes in two steps, as with a converged RATTLE
//   hoomd       HOOMD-blue's distance constraints: the same gains, and a drive ½h⁴|a|² in place of that of the
//               damping. Their condition is linear in the acceleration, σ/h² + σ̇_half/h + ½|v_half|² +
//               (r + h v_half)·a = 0 (Yoneya 2001, doi:10.1006/jcph.2001.6718), and leaves σ₊ = ½h⁴|a|²
//   rattle      roots `reduction` and 0: an error shrinks by this factor each step, as with RATTLE (taut
//               calibrate)
//   swept       a pair of roots of modulus `reduction`: an error evolves as with a fixed number of RATTLE
//               sweeps that leave this fraction of it (taut calibrate --copies slowest)
//   critical    α = β = 1/h (lagged: half of that)
//   physical    α = β = √(stiffness/μ), the frequency of the real bond, critically damped; limited to
//               βh = 1.9 (lagged: 0.79)
//   box2d       β = 2π·¼/h, α = 2β: a spring with a quarter of the step's frequency, the upper limit for
//               contacts in Box2D 3.1, and the damping ratio 2 of its joints (whose limit is an
//               eighth)
//   numbers     alpha_per_ps and beta_per_ps as given
// An explicit α or β replaces the one that the name gives.
struct GainChoice {
  std::string name = "reversible";
  std::optional<double> alpha_per_ps = {}, beta_per_ps = {};  // [1/ps]
  double reduction = 0;                                       // factor per step, for "rattle", "swept"
  double stiffness = 4.5e5;  // of the real bond, for "physical" [kJ/mol/nm²]
};

std::vector<std::string_view> gain_names();

// Returns the gains of each bond. Throws InputError for an unknown name, a missing number, or unstable gains.
std::vector<Gains> choose_gains(const GainChoice& choice, Damping damping, const System& sys, double h);
// Returns the law of each bond with its gains in steps of h; `name` as in GainChoice.
std::vector<Law> laws_of(const std::vector<Gains>& gains, Damping damping, std::string_view name, double h);

}  // namespace taut
