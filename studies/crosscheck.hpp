#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measures/liquid_structure.hpp"
#include "simulation/simulation.hpp"
#include "studies/study_scene.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// Does taut agree with OpenMM, and where they part, who is nearer the truth? One start, taken through the
// same steps by OpenMM and by each of taut's methods, without thermostat.

struct Contestant {
  std::string name;  // in a word, "newton", "baumgarte:gains=dead-beat"
  MethodOptions method;
};

// Methods in a word each. Of those that name no tolerance, projections are held to 1e-12; so are feedforward and baumgarte
// for the plug-in: by their own tolerance a bond may be solved once or twice, which on the host a row of molecules
// decides, and on a device each by itself. Throws InputError for a word that names no method or setting.
std::vector<Contestant> contestants(const std::vector<std::string>& words, bool for_plugin = false);

struct OpenMMFiles {
  std::filesystem::path system, state;
};

struct CrosscheckPlan {
  std::vector<Contestant> contestants;
  std::optional<OpenMMFiles> files;    // the scene's own, if it came from them: OpenMM then runs those
  std::string platform = "Reference";  // of the runs held against taut's
  std::string precision = {};          // of the platform of a device; empty: as OpenMM chooses
  std::string integrator = "openmm";   // "taut": that of the plug-in, beside taut's run of the same method
  double agreement = 1e-6;             // apart by more than this, two runs have parted [nm]
  long parting_steps = 1000;           // the runs that only explain end here: chaos has the word by then
  long samples = 200;
  double speed_seconds = 1;  // for each figure of speed; 0: none
  int threads = 1;           // of both

  bool plugged() const { return integrator == "taut"; }
  bool in_double() const { return platform == "Reference" || precision == "double"; }
  std::vector<std::string> usual_methods() const;  // those the report is about
};

// A run at one sample.
struct Sample {
  long step = 0;
  double t = 0;                       // [ps]
  double apart = -1;                  // from OpenMM's run, while that lasts: an atom's largest distance [nm]
  double from_truth = -1;             // the same from the fine run's, while that lasts; −1 after [nm]
  double energy = 0;                  // total [kJ/mol]
  double temperature = 0;             // [K]
  double bond_max = 0, bond_rms = 0;  // relative errors
  double settle_rms = 0, ccma_rms = 0;  // of the bonds that OpenMM holds by either of its algorithms
};

// A run whole.
struct Track {
  std::string name;
  std::string setting;  // gains, tolerance, ...
  std::vector<Sample> samples;
  std::string failure;                            // why it ended early; empty: it did not
  Estimate drift;                                 // of the total energy [kJ/mol/ns/degree of freedom]
  std::optional<Estimate> constraint_drift = {};  // the bonds' share of it, in taut's runs
  Estimate temperature;                           // [K]
  Distances oxygens;                              // empty without water or in runs too short
  Estimate end_to_end;                            // [nm], 0 without chains

  bool failed() const { return !failure.empty(); }
  double most_apart() const;                       // [nm]; −1: from no run
  double apart_at(long step) const;                // when it was last known up to there [nm]; −1: never
  std::optional<long> parted_at(double nm) const;  // first sample over it
  double worst_bond() const;
  double rms_bond(long step) const;  // over the samples up to there, but the start's
};

// Energy and forces of the start.
struct StartDifference {
  double energy = 0, openmm_energy = 0;                    // [kJ/mol]
  double force_rms = 0;                                    // [kJ/mol/nm]
  double force_difference = 0;                             // largest of a component [kJ/mol/nm]
  std::vector<std::pair<std::string, double>> terms = {};  // taut's energies by term [kJ/mol]
};

// How OpenMM holds bonds of its own: by SETTLE at lengths rounded to float, or not exactly.
struct OpenMMBonds {
  double worst = 0;          // relative error in its run
  int rounded = 0;           // bonds at the float nearest their length
  long steps = 0;            // of the runs below
  std::string failure = {};  // of those: why there are none
  std::optional<double> apart_as_given = {},
                        apart_with_theirs = {};  // newton with our lengths, with theirs [nm]
};

struct Chaos {
  double growth = 0;  // by which 1e-10 nm has grown at the end of the yardstick
  Estimate rate;      // of its exponential growth, over the second half [1/ps]
  long steps = 0;
};

struct Leapfrog {              // VerletIntegrator against the RATTLE twin, both OpenMM's
  double positions = 0;        // [nm]
  double velocities_kept = 0;  // as it keeps them, half a step behind [nm/ps]
  double velocities = 0;       // brought to the full step [nm/ps]
  long steps = 0;
  std::string failure = {};  // why there is nothing to compare
};

struct Speed {
  std::string who;
  double us_per_step = 0;
  std::string failure = {};  // why there is none
};

// One method in taut's own run, and in OpenMM by the plug-in, which is held against it.
struct Plugged {
  Track ours, theirs;
};

struct Crosscheck {
  std::string scene, openmm, platform;  // name, version, of OpenMM's runs
  std::string precision = {};           // of the platform, where that was said
  bool in_double = true;                // whether the platform computes in it
  double extent = 0;                    // largest coordinate of the start [nm]
  std::vector<std::string> notes = {};  // what is left out of the scene, a line each
  int atoms = 0, bonds = 0, dof = 0;
  double h = 0;                 // [ps]
  long steps = 0, parting = 0;  // of whole runs, of those that explain
  long every = 1, dense = 1;    // steps between even samples: of either
  int settled = 0;              // bonds that OpenMM holds by SETTLE
  double float_rounding = 0;    // rms relative error of lengths that are rounded to float
  double agreement = 0;         // apart by more, runs have parted [nm]
  StartDifference start = {};
  Track twin = {}, verlet = {}, nudged = {}, fine = {};
  std::vector<Track> openmm_own = {};  // VerletIntegrator at the tolerances that people run it with
  std::vector<Track> tracks = {};      // one a contestant
  std::vector<Plugged> plugged = {};   // in place of twin, verlet, fine and tracks
  OpenMMBonds openmm_bonds = {};
  Chaos chaos = {};
  Leapfrog leapfrog = {};
  std::vector<Speed> speed = {};
  bool long_enough = false;  // for averages to mean something
};

using Tell = std::function<void(const std::string&)>;  // what is being run now; first when the input is taken

// Throws InputError where OpenMM is missing, cannot express the scene or rejects it.
Crosscheck crosscheck(const Scene& scene, const CrosscheckPlan& plan, const Tell& tell = {});

}  // namespace taut
