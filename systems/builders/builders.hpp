#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "systems/builders/walls.hpp"
#include "systems/builders/water_models.hpp"
#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// The arguments of a builder. All its random numbers come from run.seed.
struct BuildRequest {
  const TomlTable& root;
  const TomlTable& keys;        // [build]
  const TomlTable& forcefield;  // [forcefield]
  const RunSettings& run;
  std::vector<WallKeys> walls = {};  // of every [[wall]]; build() reads and makes them
};

// Fills a scene's system, terms, start and notes: builds the kind of [build], and takes positions and
// velocities from the file build.start. If the scene's own start does not fit, because overrides ask for
// another size or density, it is ignored with a note. A start that an override names must fit. Molecules are placed
// only where there is no start. Throws InputError, and LocatedError for a wrong key.
//
// While keys are only described, it reads the keys of the kind `described` and builds nothing.
void build(BuildRequest request, Scene& scene, std::string_view described = {});
std::vector<std::string_view> kinds();

// Reads build.start, the last state of a run of the same scene; nothing where it is not said.
std::optional<State> read_named_start(const BuildRequest& request);

// Gives a scene whose system and box are made the positions and velocities of a start. Returns whether it fits; a note
// says why it does not. Throws LocatedError for one that does not fit and an override names.
bool take_start(const BuildRequest& request, State start, Scene& scene);

// Reads forcefield.precision, "double" (the default) or "mixed", which all kinds with pair forces have.
void read_precision(const TomlTable& forcefield, Terms& terms);

// The list of kinds. A builder first reads its keys, and returns if they are only described.
void build_atoms(const BuildRequest& request, Scene& scene);      // atoms and bonds one by one
void build_chains(const BuildRequest& request, Scene& scene);     // freely jointed chains without forces
void build_melt(const BuildRequest& request, Scene& scene);       // dense bead chains, Lennard-Jones or WCA
void build_water(const BuildRequest& request, Scene& scene);      // rigid water, box or droplet
void build_lammps(const BuildRequest& request, Scene& scene);     // a data file of LAMMPS
void build_molecules(const BuildRequest& request, Scene& scene);  // any molecules, defined in the scene

// Returns equilibrated water in a box wide enough for the cutoff, tiled from its unit; and the energy of a molecule
// of a model in it, with the pair forces of [forcefield] [kJ/mol].
State equilibrated_water(const State& unit, double cutoff);
double energy_of_equilibrated(const WaterModel& model, const State& waters, const TomlTable& forcefield);

// Returns copies × atoms_each as an int. Throws LocatedError at `key`, before anything is allocated, if that
// exceeds the largest number of atoms.
int atoms_of(const TomlTable& keys, std::string_view key, double copies, double atoms_each);

// The names of beads, which have no element.
Names bead_names(int polymers, int beads);

// The pair forces' keys: cutoff_nm, switch_nm, shift, dispersion_correction; dielectric; coulomb = "reaction-field" with
// rf_dielectric and rf_excluded, "cutoff", or "pme" with ewald_tolerance, ewald_alpha_per_nm, pme_order, pme_grid. With a box
// the cutoff is required, and at most half the box. Without a key the value of `nonbonded` stays.
void read_cutoff(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded);

}  // namespace taut
