#pragma once

#include <string>

#include "base/archive.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// What acts on velocities and the box between the parts of a step (md/integrator.hpp): a barostat, and a thermostat
// that scales velocities. This one does nothing. Each stage returns what heat it gives to the kinetic energy [kJ/mol].
class Bath {
 public:
  virtual ~Bath() = default;

  // May change the box, and x and v with it, where the forces are evaluated next.
  virtual double move_box(const System&, State&) { return 0; }
  // At the end of a step of length h [ps].
  virtual double after_step(const System&, double /*h*/, State&) { return 0; }

  virtual void set_temperature(double /*kelvin*/) {}  // of what it draws from here on

  virtual void serialize(Archive&) {}  // what it takes from one step to the next
  // What speaks against the ensemble it gave; empty: nothing.
  virtual std::string doubt() const { return ""; }
};

inline Bath& no_bath() {
  static Bath none;
  return none;
}

}  // namespace taut
