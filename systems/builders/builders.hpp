#pragma once

#include <string_view>
#include <vector>

#include "systems/scene.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// What a builder is given. Everything it draws comes from run.seed.
struct BuildRequest {
  const TomlTable& root;
  const TomlTable& keys;        // [build]
  const TomlTable& forcefield;  // [forcefield]
  const RunSettings& run;
};

// Fills a scene's system, terms, start and notes: builds [build]'s kind, puts its atoms where the file
// build.start says, with the velocities it has. A start of the scene's own that does not fit (other counts,
// another density) is set aside with a note: a scene ships with the start of its own numbers, and others may
// be asked for. One that an override names has to fit.
// Throws InputError, LocatedError where a key is to blame.
//
// Where keys are only described, it is the kind `described` whose keys are read, and nothing is built.
void build(const BuildRequest& request, Scene& scene, std::string_view described = {});
std::vector<std::string_view> kinds();

// Reads forcefield.precision, "double" (unless said) or "mixed", which all kinds with pair forces have.
void read_precision(const TomlTable& forcefield, Terms& terms);

// The one list of kinds. A builder first reads its keys, and returns where they are only described.
void build_atoms(const BuildRequest& request, Scene& scene);      // atoms and bonds one by one
void build_chains(const BuildRequest& request, Scene& scene);     // freely jointed chains without forces
void build_rings(const BuildRequest& request, Scene& scene);      // closed rings without forces
void build_melt(const BuildRequest& request, Scene& scene);       // dense bead chains, Lennard-Jones or WCA
void build_water(const BuildRequest& request, Scene& scene);      // rigid water, box or droplet
void build_molecules(const BuildRequest& request, Scene& scene);  // any molecules, said in the scene

// The atoms of `copies` things of `atoms_each`, as an int. Throws LocatedError at `key` for more than taut
// takes, before anything is allocated.
int atoms_of(const TomlTable& keys, std::string_view key, double copies, double atoms_each);

// Polymers of beads, of no element.
Names bead_names(int polymers, int beads);

// The pair forces' keys: cutoff_nm, switch_nm, dispersion_correction; coulomb = "reaction-field" with
// rf_dielectric, "cutoff", or "pme" with ewald_tolerance, ewald_alpha_per_nm, pme_order, pme_grid. With a box
// the cutoff is required, and at most half the box. What no key says stays as `nonbonded` has it.
void read_cutoff(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded);

}  // namespace taut
