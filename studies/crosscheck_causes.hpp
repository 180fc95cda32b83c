#pragma once

// Why two runs part: each cause measured by a run of its own.

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

}  // namespace taut
