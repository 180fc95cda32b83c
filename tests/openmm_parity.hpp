#pragma once

// What is checked against OpenMM's Reference platform.

#include <gtest/gtest.h>

#include <cmath>

#include "forcefield/force_field.hpp"
#include "openmm_models.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/input.hpp"

namespace taut::tests {

inline double rms(const Vectors& f) {
  return std::sqrt(f.squaredNorm() / static_cast<double>(f.size()));
}

// Energy to 1e-9, every force component to 1e-7 of their rms.
inline void expect_agreement(double energy, const Vectors& f, double their_energy, const Vectors& their_f) {
  EXPECT_NEAR(energy, their_energy, 1e-9 * std::abs(their_energy));
  ASSERT_EQ(f.cols(), their_f.cols());
  EXPECT_LT((f - their_f).cwiseAbs().maxCoeff(), 1e-7 * rms(their_f));
}

// taut's potential and forces against those of the twin, live. `more`: what taut's potential has and OpenMM's
// not.
inline void expect_parity(const Files& files, double more = 0) {
  OpenMMInput input = read_openmm(files.system, files.state);
  ForceField forces(input.system, input.start.box, input.terms);
  const double energy = forces.evaluate_energy(input.system, input.start);
  const OpenMMTwin twin(files.system, files.state, {0.001});
  expect_agreement(energy, input.start.f, twin.potential() + more, twin.state().f);
}

}  // namespace taut::tests
