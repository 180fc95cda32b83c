#pragma once

#include <string>

#include "base/errors.hpp"
#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Why a step failed, judged by the state that it left and, where it is known, the state before.
struct Diagnosis {
  long step = 0;
  double t = 0;                          // [ps]
  std::string cause;                     // in the words of the method or the force
  int bond = -1;                         // the bond to blame; −1: none
  RigidBond held{-1, -1, 0};             // its atoms and target [nm]
  double length = 0, length_before = 0;  // now, and in the state before the step where it is known [nm]
  double largest_force = 0;              // [kJ/mol/nm]
  int atom = 0;                          // on which
  std::string advice;

  std::string text() const;  // one clear paragraph
};
Diagnosis diagnose(const System& sys, const State& s, const SolveStats& stats, long step);

// A step was taken, but its solves did not converge, a bond broke or a number is not finite.
struct StepFailure : SimulationFailure {
  StepFailure(const Diagnosis& diagnosis, const SolveStats& of_step)
      : SimulationFailure(diagnosis.text()), stats(of_step) {}

  SolveStats stats;
};

// Throws SimulationFailure with the diagnosis where a solve has failed.
void demand_converged(const System& sys, const State& s, const SolveStats& stats, long step);

}  // namespace taut
