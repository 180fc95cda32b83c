#pragma once

#include "constraints/projection.hpp"
#include "ensembles/pressure.hpp"

namespace taut::tests {

// The pressure's tensor of a state, whose forces are evaluated for it [bar]. `springs`: multipliers of a penalty.
inline Eigen::Matrix3d pressure_of(const System& sys, ForceField& forces, State s,
                                   const Eigen::VectorXd* springs = nullptr) {
  ForceField::Evaluation besides;
  forces.evaluate(sys, s, besides);
  return pressure(sys, forces, s, besides, springs ? *springs : Projector(sys).multipliers(sys, s));
}

}  // namespace taut::tests
