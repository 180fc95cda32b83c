#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/course.hpp"
#include "base/names.hpp"
#include "constraints/registry.hpp"
#include "forcefield/terms.hpp"
#include "md/moving_anchors.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

struct RunSettings {
  double dt_fs = 1;
  long steps = 1000;
  double temperature_k = 0;          // of velocities drawn at the start and of the thermostat [K]; 0: none
  Course temperature_course;         // of the thermostat [ps, K]; empty: temperature_k throughout
  Course pull_factor;                // by which all pulls are multiplied [ps, 1]; empty: 1
  std::string velocities;            // "keep" those of the start, "draw" them; "": draw if it has none
  std::uint64_t seed = 1;            // of all random numbers
  long log_every = 100;              // steps
  long remove_momentum_every = 0;    // steps; 0: never
  std::string redundant = "refuse";  // what to do with redundant bonds: "refuse" or "drop"
  long trajectory_every = 0;         // steps between frames; 0: no trajectory
  std::string trajectory = "dcd";    // "dcd", "h5md" or "both"
  long checkpoint_every = 0;         // steps; 0: only by the clock and at the end
  double checkpoint_minutes = 5;     // computing time between checkpoints; 0: not by the clock
  std::string thermostat;         // "langevin", "rescaling", "none"; "": rescaling if thermostat_ps is given
  double thermostat_ps = 0;       // relaxation time of velocity rescaling to temperature_k
  double friction_per_ps = 1;     // of Langevin dynamics
  std::string barostat = "none";  // "c-rescale", "monte-carlo" or "none" (ensembles/)
  double pressure_bar = 1;        // of the barostat
  long barostat_every = 10;       // steps
  double barostat_ps = 1;         // relaxation time of c-rescale
  double compressibility_per_bar = 4.5e-5;  // estimate for c-rescale; the default is water's
  // Edges that scale together: all ("isotropic"), x and y ("semi-isotropic"), or none ("anisotropic").
  std::string coupling = "isotropic";
  bool soft_start = false;  // push overlapping atoms apart by soft forces first (simulation/soft_start.hpp)
  bool minimise = false;    // minimise the energy of the start first (simulation/minimise.hpp)
  bool metric_correction = false;  // Fixman's potential at temperature_k (constraints/metric_potential.hpp)
  double minimise_force = 1000;    // largest force on an atom at which the minimiser stops [kJ/mol/nm]
  std::vector<std::array<int, 2>> tension_of;  // atoms of rigid bonds whose tension the log has

  double bath_temperature(double t) const {
    return temperature_course.empty() ? temperature_k : temperature_course.at(t);
  }
  double h() const { return dt_fs * 1e-3; }  // [ps]
  bool langevin() const { return thermostat == "langevin"; }
  bool rescaling() const { return thermostat == "rescaling" || (thermostat.empty() && thermostat_ps > 0); }
  bool thermostatted() const { return langevin() || rescaling(); }
  bool barostatted() const {
    return barostat != "none" && thermostatted();
  }  // a barostat alone has no temperature
};

// A system with a start and run settings.
struct Scene {
  std::string name;
  std::string hard_on;  // one sentence
  System system;
  Terms terms;
  std::vector<AnchorMotion> motions;                       // of anchors, which stand without one
  Names names;                                             // names of the atoms, for files
  State start;                                             // x and v, not yet projected onto the bonds
  bool positions_drawn = false, velocities_drawn = false;  // from run.seed
  RunSettings run;
  MethodOptions method;
  std::vector<std::filesystem::path>
      files;                       // its sources: the scene and the files it names, or OpenMM's two files
  std::vector<std::string> notes;  // messages for the user about the start, one line each

  bool foreign_fields() const {
    for (const auto& field : terms.own)
      if (field->kind() == OwnField::Kind::kFromOutside) return true;
    return false;
  }

  // True if no external force acts, so that the momentum is conserved. Biases act between atoms alone.
  bool closed() const { return closed_but_for_restraints() && terms.restraints.empty(); }
  bool closed_but_for_restraints() const { return !driven() && system.anchors() == 0; }
  bool acted_on() const { return driven() || !terms.restraints.empty(); }  // by more than anchors

 private:
  bool driven() const {
    return terms.gravity || !terms.pulls.empty() || !terms.walls.empty() || !terms.steered.empty() ||
           foreign_fields() || !motions.empty();
  }
};

}  // namespace taut
