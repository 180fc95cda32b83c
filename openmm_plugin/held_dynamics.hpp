#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

// taut's step as the plug-in uses it. This header is C++17 without Eigen, as what includes OpenMM's headers.
namespace taut {

// A rigid bond between two atoms.
struct HeldBond {
  int i, j;
  double length;  // [nm]
};

// What a TautIntegrator is made from.
struct HoldSettings {
  double h = 0.002;                            // length of a step [ps]
  std::string method = "feedforward";          // one of `taut methods`
  std::map<std::string, std::string> options;  // of the method, by its own names: {"tolerance", "1e-8"}
  double friction = 0;                         // of the Langevin thermostat [1/ps]; 0: no thermostat
  double temperature = 0;                      // of the thermostat [K]
  std::uint64_t seed = 0;                      // of its random numbers; 0: a new one for every Context
  std::vector<HeldBond> bonds = {};            // which it holds besides the System's constraints
};

// Throws InputError for an unknown method or option and for a value out of range.
void check_settings(const HoldSettings& settings);
// Sets the method's option `tolerance`. Throws InputError if the method has none.
void set_tolerance(HoldSettings& settings, double tolerance);
// Returns the method's `tolerance`, or 1e-5 if it has none.
double tolerance(const HoldSettings& settings);

// Rigid bonds between atoms that have masses. A mass of 0 is a virtual site or an atom that never moves.
struct HeldBonds {
  std::vector<double> masses;  // [u]
  std::vector<HeldBond> bonds;
};

// What the step asks of the program that computes the forces. Arrays have three numbers an atom.
class Engine {
 public:
  virtual ~Engine() = default;
  // Carries out what acts once a step besides the forces: barostat, removal of the momentum, ... It is called
  // with the positions at the end of the step and the velocities of the half step, and may change both.
  virtual void update(double t, double* x, double* v) = 0;
  virtual void forces(double t, const double* x, double* f) = 0;
};

// Brings positions and velocities to the bonds, to round-off, by the smallest mass-weighted change.
class BondProjection {
 public:
  explicit BondProjection(const HeldBonds& held);
  ~BondProjection();
  void positions(double* x);
  void velocities(const double* x, double* v);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Velocity Verlet (md/velocity_verlet.hpp), whose bonds are held by a method of constraints, with or without a
// Langevin thermostat. Throws InputError and SimulationFailure.
class HeldDynamics {
 public:
  HeldDynamics(const HeldBonds& held, const HoldSettings& settings, int threads);
  ~HeldDynamics();

  double* x();  // positions [nm]
  double* v();  // velocities at full steps [nm/ps]

  // Brings x and v to the bonds, and finds the forces and the first multipliers. All that was known before is
  // forgotten, but for the random numbers' count.
  void start(double t, Engine& engine);
  // One step from time t on. After an exception only start() may follow.
  void step(double t, Engine& engine);

  // Of the motion in the tangent space of the bonds [kJ/mol]: at full steps, and with a thermostat in the
  // middle of its jump, where it is canonical whatever the step (ensembles/drift_velocity.hpp).
  double kinetic_energy();
  void set_bath(double temperature, double friction);

  // What start() and all steps have left, for checkpoints.
  std::string save();
  void load(const std::string& kept);  // throws InputError for what another system or method has left

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace taut
