#pragma once

#include <vector>

#include "systems/builders/lammps_rows.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// What the pair forces of a data file depend on beside its coefficients.
struct LammpsAtoms {
  const std::vector<int>& type;  // from 0
  const Eigen::VectorXd& charge;
  bool bonds_exclude;  // false: FENE's bonds repel, and their pairs are pairs here
};

// σ and ε of each type, by a table where no rule of mixing has them, charges and special_bonds. Nothing if no atom has
// an ε or a charge.
void read_lammps_pairs(const LammpsRows& rows, const LammpsAtoms& atoms, Scene& scene);

// Reads the cutoffs of the file and of [forcefield] (read_cutoff), which must be one for all pairs; those of wca are at
// its minimum.
void read_lammps_cutoffs(const LammpsRows& rows, const TomlTable& forcefield, Scene& scene);

}  // namespace taut
