#pragma once

#include <functional>
#include <optional>
#include <string>

#include "constraints/langevin.hpp"
#include "constraints/redundancy.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "md/thermostat.hpp"
#include "systems/scene.hpp"

namespace taut {

// One row of the log.
struct Record {
  long step = 0;
  double t = 0;                       // [ps]
  double potential = 0, kinetic = 0;  // [kJ/mol]
  double temperature = 0;             // [K], under Langevin's thermostat of the velocity it acts on
  BondErrors bonds;
  double drift = 0;       // of the total energy so far [kJ/mol/ns/degree of freedom]
  double iterations = 0;  // a step, since the last row
  double ns_per_day = 0;

  double total() const { return potential + kinetic; }
};

// What a run came to.
struct Summary {
  long steps = 0;
  double us_per_step = 0, constraint_us_per_step = 0, ns_per_day = 0;
  double max_rel_bond_error = 0;      // over all rows
  double rms_rel_bond_error = 0;      // root mean square over all rows
  double drift = 0, drift_error = 0;  // [kJ/mol/ns/degree of freedom], and its standard error
  double temperature = 0;             // mean over the rows [K]
  double potential = 0, total = 0;    // at the end [kJ/mol]
  bool converged = true;
};

// A scene ready to run: forces and method made, the start brought to the bonds.
class Simulation {
 public:
  explicit Simulation(Scene scene);

  const Scene& scene() const { return scene_; }
  const State& state() const { return state_; }
  const DegreesOfFreedom& dof() const { return dof_; }
  int clusters() const { return clusters_; }
  std::string method_setting() const;  // gains, tolerance, ...
  double promised_error() const;       // relative, of a bond; infinity: none
  Eigen::VectorXd bond_tensions()
      const;  // of the last step, least norm where bonds are redundant [kJ/mol/nm]
  const ForceField& forces() const { return forces_; }

  Record record() const;  // the state as it is now
  // What temperatures are taken of: under Langevin's thermostat the velocity it acts on, or else v [nm/ps].
  Vectors thermal_velocity() const;

  // Takes the scene's steps. `on_record` sees a row every run.log_every steps, and the start; `on_step`
  // sees every step's number. Throws SimulationFailure.
  Summary run(const std::function<void(const Record&)>& on_record,
              const std::function<void(long)>& on_step = {});

 private:
  void make_langevin();
  void visit_step(auto&& visit);
  bool has_springs() const;      // in place of constraints
  double method_energy() const;  // of a penalty's springs

  System full_;  // with the bonds that were left out, if any were
  Redundancy redundancy_;
  Scene scene_;
  ForceField forces_;
  Method method_;
  State state_;
  DegreesOfFreedom dof_;
  int clusters_ = 0;
  std::optional<VelocityRescaling> thermostat_;
  mutable std::optional<Langevin> langevin_;  // measuring a temperature takes its scratch
};

}  // namespace taut
