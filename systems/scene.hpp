#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/names.hpp"
#include "constraints/registry.hpp"
#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

struct RunSettings {
  double dt_fs = 1;
  long steps = 1000;
  double temperature_k = 0;          // of what is drawn at the start, and of the thermostat; 0: none
  std::string velocities;            // "keep" the start's, "draw" them; "": draw where it has none
  std::uint64_t seed = 1;            // of everything drawn
  long log_every = 100;              // steps
  long remove_momentum_every = 0;    // steps; 0: never
  std::string redundant = "refuse";  // bonds that follow from others: "refuse" or "drop"
  long trajectory_every = 0;         // steps from frame to frame; 0: no trajectory
  std::string trajectory = "dcd";    // "dcd", "h5md" or "both"
  long checkpoint_every = 0;         // steps; 0: by the clock and where it stops, alone
  double checkpoint_minutes = 5;     // of computing from checkpoint to checkpoint; 0: not by the clock
  std::string thermostat;      // "langevin", "rescaling", "none"; "": rescaling where thermostat_ps is given
  double thermostat_ps = 0;    // relaxation time of velocity rescaling to temperature_k
  double friction_per_ps = 1;  // of Langevin's thermostat
  std::string barostat = "none";            // "c-rescale", "monte-carlo" or "none" (ensembles/)
  double pressure_bar = 1;                  // it keeps
  long barostat_every = 10;                 // steps
  double barostat_ps = 1;                   // relaxation time of c-rescale
  double compressibility_per_bar = 4.5e-5;  // c-rescale's guess of it: water's
  std::string coupling =
      "isotropic";               // which edges change alike: "semi-isotropic" x and y, "anisotropic" none
  bool minimise = false;         // relax the start first (simulation/minimise.hpp)
  double minimise_force = 1000;  // until no atom's force is above this [kJ/mol/nm]

  double h() const { return dt_fs * 1e-3; }  // [ps]
  bool langevin() const { return thermostat == "langevin"; }
  bool rescaling() const { return thermostat == "rescaling" || (thermostat.empty() && thermostat_ps > 0); }
  bool thermostatted() const { return langevin() || rescaling(); }
  bool barostatted() const {
    return barostat != "none" && thermostatted();
  }  // of itself it has no temperature
};

// A system with a start, a step and what it is hard on.
struct Scene {
  std::string name;
  std::string hard_on;  // one sentence
  System system;
  Terms terms;
  Names names;                                             // of the atoms, for files
  State start;                                             // x and v; not yet made to satisfy the bonds
  bool positions_drawn = false, velocities_drawn = false;  // by run.seed
  RunSettings run;
  MethodOptions method;
  std::vector<std::filesystem::path>
      files;                       // it was read from: the scene's and those it names, or OpenMM's two
  std::vector<std::string> notes;  // what the reader should know of the start, a line each

  // Nothing outside holds or pulls: the momentum is conserved.
  bool closed() const { return closed_but_for_restraints() && terms.restraints.empty(); }
  bool closed_but_for_restraints() const {
    return !terms.gravity && terms.pulls.empty() && terms.own.empty() && system.anchors() == 0;
  }
};

}  // namespace taut
