#pragma once

#include "ensembles/pressure.hpp"

namespace taut::tests {

// The pressure's tensor of a state, whose forces are evaluated for it [bar]. `springs`: multipliers of a penalty.
inline Eigen::Matrix3d pressure_of(const System& sys, ForceField& forces, State s,
                                   const Eigen::VectorXd* springs = nullptr) {
  ForceField::Evaluation besides;
  forces.evaluate(sys, s, besides);
  return Barometer(sys, springs != nullptr)
      .pressure(sys, forces, s, besides, springs ? *springs : Eigen::VectorXd());
}

}  // namespace taut::tests
