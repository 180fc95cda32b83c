#pragma once

#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// What acts on velocities besides forces and constraints; this one does nothing. A thermostat that changes them
// by Δ in the middle of the drift gives ½Δ before it and ½Δ after; others act after the step, as barostats do.
class Bath {
 public:
  virtual ~Bath() = default;

  virtual const Vectors* half_jump() const { return nullptr; }  // ½Δ of the drift under way, until draw()
  // The next Δ; f is told of it, for those who steer by forces.
  virtual SolveStats draw(const System&, double /*h*/, State&) { return {}; }
  // The first Δ: v is the full-step velocity, and there is none before.
  virtual SolveStats start(const System&, State&) { return {}; }
  virtual void second_half(State&) {}  // f forgets it; v += ½ of the Δ before
  virtual void after_step(const System&, double /*h*/, State&) {}
};

Bath& no_bath();

}  // namespace taut
