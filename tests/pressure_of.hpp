#pragma once

#include "constraints/projection.hpp"
#include "ensembles/pressure.hpp"

namespace taut::tests {

// The pressure's tensor of a state, whose forces are evaluated for it [bar]. `springs`: multipliers of a penalty.
inline Eigen::Matrix3d pressure_of(const System& sys, ForceField& forces, State s,
                                   const Eigen::VectorXd* springs = nullptr) {
  ForceField::Evaluation evaluation;
  forces.evaluate(sys, s, evaluation);
  return pressure(sys, forces, s, evaluation, springs ? *springs : Projector(sys).multipliers(sys, s));
}

}  // namespace taut::tests
