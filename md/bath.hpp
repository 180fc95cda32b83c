#pragma once

#include "md/constraint_method.hpp"

namespace taut {

// What acts on velocities besides forces and constraints; this one does nothing. A thermostat that changes them
// by Δ in the middle of the drift gives ½Δ before it and ½Δ after; others act after the step, as barostats do.
class Bath {
 public:
  virtual ~Bath() = default;

  // What a draw found for the step to come.
  struct Draw {
    SolveStats stats;
    const Vectors* noise = nullptr;           // of Push, for whoever steers by forces [kJ/mol/nm]
    const Vectors* last_half_jump = nullptr;  // the second half of the Δ before, still to be added [nm/ps]
  };

  // ½Δ of the drift under way, until draw() [nm/ps]; null: no thermostat acts in the drift.
  virtual const Vectors* half_jump() const { return nullptr; }
  // Draws the next Δ. f is the force at x, without those of constraints. At the start there is no Δ before.
  virtual Draw draw(const System&, const Push&, const State&) { return {}; }
  virtual void after_step(const System&, double /*h*/, State&) {}
};

Bath& no_bath();

}  // namespace taut
