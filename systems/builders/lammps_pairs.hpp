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

// A row of Pair Coeffs, of a type with itself, or of PairIJ Coeffs.
struct LammpsPairRow {
  const LammpsData::Entry* entry;
  int i, j;                     // types, from 0
  double epsilon, sigma;        // [kJ/mol], [nm]
  std::vector<double> cutoffs;  // of Lennard-Jones, and of Coulomb; empty: those of pair_style
};

struct LammpsPairRows {
  std::string style;
  bool mixes = true;  // false: the file has every two types
  std::vector<LammpsPairRow> all;
};
LammpsPairRows read_lammps_pair_rows(const LammpsRows& rows);

// σ and ε of each type, by a table where no rule of mixing has them, charges and special_bonds. Nothing if no atom has
// an ε or a charge.
void read_lammps_pairs(const LammpsRows& rows, const LammpsPairRows& read, const LammpsAtoms& atoms,
                       Scene& scene);

// Reads the cutoffs of the file and of [forcefield] (read_cutoff), which must be one for all pairs; those of wca are at
// its minimum.
void read_lammps_cutoffs(const LammpsRows& rows, const LammpsPairRows& read, const TomlTable& forcefield,
                         Scene& scene);

}  // namespace taut
