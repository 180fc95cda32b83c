#pragma once

#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// A scene as LAMMPS reads it: a data file, and an input file with the styles that go with it, rigid bonds held by
// fix taut. In LAMMPS's units "lj" of 1 nm, 1 kJ/mol and 1 u, in which all numbers are taut's own and the unit of
// time is 1 ps.
struct LammpsFiles {
  std::string data, input;
  std::string tables;  // of energies; empty if there is none
};

// `data_name` is the data file's name for the input; that of tables has the extension .table instead. Throws
// InputError, one line, for what LAMMPS's usual styles cannot say: virtual sites but those of water of four sites,
// one-sided bonds, correction maps, harmonic torsions of other angles than 0 and 180 degrees, forces from outside but
// gravity and walls, FENE springs without repulsion of all pairs, exceptions that are no special_bonds.
LammpsFiles lammps_files(const Scene& scene, const std::string& data_name);

// Writes PREFIX.data and PREFIX.in, and PREFIX.table where energies are by tables.
void write_lammps(const Scene& scene, const std::string& prefix);

}  // namespace taut
