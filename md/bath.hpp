#pragma once

#include <string>

#include "base/archive.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// A thermostat or a barostat: what acts on velocities and the box besides forces and constraints. It acts in
// up to four stages of the step (md/step.hpp), all empty here: this one does nothing. Each stage says what
// heat it gives to the kinetic energy [kJ/mol].
class Bath {
 public:
  virtual ~Bath() = default;

  // A thermostat that changes velocities by Δ in the middle of the drift gives ½Δ before it and ½Δ after.
  // This is the ½Δ of the drift under way, until draw() [nm/ps]; null: none acts in the drift.
  virtual const Vectors* half_jump() const { return nullptr; }

  // May change the box, and x and v with it, where the forces are evaluated next. Returns its heat.
  virtual double move_box(const System&, State&) { return 0; }

  // What a draw found for the step to come.
  struct Draw {
    SolveStats stats = {};
    double heat = 0;                 // of the Δ before, as far as it was not known when that was drawn
    const Vectors* noise = nullptr;  // of Push, for methods that steer by forces [kJ/mol/nm]
    const Vectors* last_half_jump = nullptr;  // the second half of the Δ before, still to be added [nm/ps]
  };
  // Draws the next Δ. f is the force at x without those of constraints. At the start there is no Δ before.
  virtual Draw draw(const System&, const Push&, const State&) { return {}; }

  // At the end of a step of length h [ps]. Returns its heat.
  virtual double after_step(const System&, double /*h*/, State&) { return 0; }

  virtual void set_temperature(double /*kelvin*/) {}  // of what it draws from here on

  virtual void serialize(Archive&) {}  // what it takes from one step to the next
  virtual std::string doubt() const {
    return "";
  }  // what speaks against the ensemble it gave; empty: nothing
};

Bath& no_bath();

}  // namespace taut
