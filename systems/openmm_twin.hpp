#pragma once

#include <filesystem>
#include <memory>

#include "md/state.hpp"

namespace taut {

// OpenMM itself, run beside taut as a witness, on the Reference platform (double precision).
class OpenMMTwin {
 public:
  // The same two files as import_openmm reads. `h` in ps.
  // Integrator: the true twin of our RATTLE, a CustomIntegrator (OpenMM's own Verlet is leap-frog):
  //   v += ½hf/m; x += hv; x1 = x; constrain positions; v += ½hf/m + (x−x1)/h; constrain velocities.
  OpenMMTwin(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml, double h,
             double constraint_tolerance = 1e-12);
  ~OpenMMTwin();

  void set(const State& s);  // positions and velocities
  void step(int n);
  State state() const;       // x (unwrapped), v, f: OpenMM's forces, without constraint forces
  double potential() const;  // [kJ/mol]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
