#pragma once

// Why two runs part: each cause measured by a run of its own.

#include "constraints/methods/baumgarte.hpp"
#include "studies/crosscheck_runs.hpp"

namespace taut {

StartDifference compare_start(const Stage& stage, OpenMMTwin& twin);

// Whether OpenMM holds lengths rounded to float, and if so, newton against it with our lengths and with
// those.
OpenMMBonds openmm_bonds(const Stage& stage, double worst_seen);

// A second run, every atom moved by 1e-10 nm: how chaos alone tears two runs apart. It is OpenMM's, or taut's
// of a contestant, since a device may compute in single precision.
Track nudged_run(const Stage& stage, const Against& against);
Track nudged_run(const Stage& stage, const Contestant& contestant, const Against& against);
Chaos chaos_of(const Track& nudged);

Leapfrog compare_leapfrog(const Stage& stage);

// Where Baumgarte will have gone, without running it.
//
// It puts forces along the bonds, at x_n, as SHAKE does; so its positions follow from its residuals σ_n
// alone: newton, told to leave just those σ, takes the same ones. And the residuals are known beforehand
// (constraints/methods/propagator.hpp):
//     σ_{n+1} = T σ_n − D σ_{n−1} + (1 − T + D) floor(v, a),
// from σ_0 = 0 and the σ_1 = ½h³ v·a + ⅛h⁴a² that a start with σ̇ = 0 leaves, and what its guess of λ misses
// by. v, a and λ are newton's.
Foretold foretell(const Stage& stage, const Baumgarte::Options& options, const Frames& openmm);

}  // namespace taut
