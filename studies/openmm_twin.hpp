#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "md/state.hpp"

namespace OpenMM {
class System;
}

namespace taut {

struct OpenMMInput;  // openmm/input.hpp

bool built_with_openmm();  // which the twin needs, and nothing else

// Integrators the twin can run.
//
// kRattle: the true twin of our RATTLE, a CustomIntegrator:
//   v += ½hf/m; x += hv; x1 = x; constrain positions; v += ½hf/m + (x−x1)/h; constrain velocities.
// kVerlet: OpenMM's own VerletIntegrator, which is leap-frog: it keeps v_{n−½}. Started from
//   v_{−½} = v₀ − ½hf₀/m  it takes RATTLE's very positions (what lies along the bonds is projected out in
// either), and RATTLE's velocity is  v_n = P(v_{n−½} + ½hf_n/m), P taking out the part along the bonds.
//
// kTaut: TautIntegrator of taut's plug-in for OpenMM (openmm_plugin/README.md), which takes taut's own step.
enum class TwinIntegrator { kRattle, kVerlet, kTaut };

struct TwinSettings {
  double h = 0;                         // [ps]
  double constraint_tolerance = 1e-12;  // relative for positions; for velocities, absolute
  std::string platform =
      "Reference";  // in double precision, for parity; CPU, pair forces in single, for speed
  TwinIntegrator integrator = TwinIntegrator::kRattle;
  int threads = 0;             // of the CPU platform; 0: as OpenMM chooses
  std::string precision = {};  // of a device's platform: single, mixed, double; empty: as OpenMM chooses
  std::string method = {};     // of kTaut, by its name
  std::map<std::string, std::string> options = {};  // of the method, by their names
};

// OpenMM itself, run beside taut as a witness. It never removes the momentum, even where the file has a
// CMMotionRemover.
// Its floor: OpenMM's SETTLE, for rigid water, holds distances as float (6e-8 relative); its CCMA, for all
// other bonds, stops after 150 iterations without a word.
class OpenMMTwin {
 public:
  // Reads the same two files as import_openmm and starts at the State as it is, with its velocities taken for
  // those of the integrator: molecules broken across the box stay broken until set().
  OpenMMTwin(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml,
             const TwinSettings& settings);
  // The same system built in memory. Throws InputError for what OpenMM cannot express or rejects.
  OpenMMTwin(const OpenMMInput& input, const TwinSettings& settings);
  ~OpenMMTwin();

  void set(const State& s);  // positions, full-step velocities, time and box; nothing is constrained
  void step(int n);
  State state() const;  // x (unwrapped), full-step v, t, f: OpenMM's forces, without constraint forces
  Vectors kept_velocities() const;       // as the integrator keeps them: kVerlet's lag by half a step [nm/ps]
  double potential() const;              // [kJ/mol]
  State state(double& potential) const;  // both, for one evaluation of the forces

  // Leaves the twin at x, writes the forces there into f, returns the potential [kJ/mol].
  double forces_at(const Vectors& x, Vectors& f);

 private:
  void start(std::unique_ptr<OpenMM::System> system, const TwinSettings& settings);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

std::string openmm_version();

}  // namespace taut
