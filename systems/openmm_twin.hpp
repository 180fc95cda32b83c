#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "md/state.hpp"

namespace taut {

// OpenMM itself, run beside taut as a witness.
//
// Integrator: the true twin of our RATTLE, a CustomIntegrator (OpenMM's own Verlet is leap-frog):
//   v += ½hf/m; x += hv; x1 = x; constrain positions; v += ½hf/m + (x−x1)/h; constrain velocities.
// It never removes the momentum, even where the file has a CMMotionRemover.
// Its floor: OpenMM's SETTLE, for rigid water, holds distances as float (6e-8 relative); its CCMA, for all
// other bonds, stops after 150 iterations without a word.
class OpenMMTwin {
 public:
  // Reads the same two files as import_openmm and starts at the State as it is: molecules broken across the
  // box stay broken until set(). `h` [ps], `constraint_tolerance` relative. Platforms: Reference, in double
  // precision, for parity; CPU, whose pair forces are single precision, for speed.
  OpenMMTwin(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml, double h,
             double constraint_tolerance = 1e-12, const std::string& platform = "Reference");
  ~OpenMMTwin();

  void set(const State& s);  // positions, velocities and time; nothing is constrained
  void step(int n);
  State state() const;       // x (unwrapped), v, t, f: OpenMM's forces, without constraint forces
  double potential() const;  // [kJ/mol]

  // Leaves the twin at x, writes the forces there into f, returns the potential [kJ/mol].
  double forces_at(const Vectors& x, Vectors& f);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
