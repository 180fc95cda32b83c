#pragma once

#include <string_view>
#include <vector>

#include "systems/scene.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// The arguments of a builder. All its random numbers come from run.seed.
struct BuildRequest {
  const TomlTable& root;
  const TomlTable& keys;        // [build]
  const TomlTable& forcefield;  // [forcefield]
  const RunSettings& run;
};

// Fills a scene's system, terms, start and notes: builds the kind of [build], and takes positions and
// velocities from the file build.start. If the scene's own start does not fit, because overrides ask for
// another size or density, it is ignored with a note. A start that an override names must fit. Throws
// InputError, and LocatedError for a wrong key.
//
// While keys are only described, it reads the keys of the kind `described` and builds nothing.
void build(const BuildRequest& request, Scene& scene, std::string_view described = {});
std::vector<std::string_view> kinds();

// Reads forcefield.precision, "double" (the default) or "mixed", which all kinds with pair forces have.
void read_precision(const TomlTable& forcefield, Terms& terms);

// The list of kinds. A builder first reads its keys, and returns if they are only described.
void build_atoms(const BuildRequest& request, Scene& scene);      // atoms and bonds one by one
void build_chains(const BuildRequest& request, Scene& scene);     // freely jointed chains without forces
void build_rings(const BuildRequest& request, Scene& scene);      // closed rings without forces
void build_melt(const BuildRequest& request, Scene& scene);       // dense bead chains, Lennard-Jones or WCA
void build_water(const BuildRequest& request, Scene& scene);      // rigid water, box or droplet
void build_molecules(const BuildRequest& request, Scene& scene);  // any molecules, defined in the scene

// Returns copies × atoms_each as an int. Throws LocatedError at `key`, before anything is allocated, if that
// exceeds the largest number of atoms.
int atoms_of(const TomlTable& keys, std::string_view key, double copies, double atoms_each);

// The names of beads, which have no element.
Names bead_names(int polymers, int beads);

// The pair forces' keys: cutoff_nm, switch_nm, dispersion_correction; coulomb = "reaction-field" with
// rf_dielectric, "cutoff", or "pme" with ewald_tolerance, ewald_alpha_per_nm, pme_order, pme_grid. With a box
// the cutoff is required, and at most half the box. Without a key the value of `nonbonded` stays.
void read_cutoff(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded);

}  // namespace taut
