#pragma once

#include <map>
#include <string>

#include "files/coordinate_file.hpp"
#include "systems/molecules/molecule.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// An atom's numbers: a section [atom.NAME], or one of the atoms of a molecule.
struct AtomNumbers {
  AtomKind kind;
  double mass = 0;     // [u]
  double charge = 0;   // [e]
  double sigma = 1;    // [nm]
  double epsilon = 0;  // [kJ/mol]
};
using KnownAtoms = std::map<std::string, AtomNumbers>;

inline constexpr double kMostAtoms = 5e6;  // about 2 GB of arrays and lists

// [atom.NAME]
AtomNumbers read_atom(const TomlTable& keys, const std::string& name);

// [molecule.NAME]. Rows are of atoms, counted from 0, and numbers; they and the atoms are said of one unit
// and count in all. All atoms of a molecule are tied, by bonds, springs or FENE springs. Where keys are only
// described, there are no atoms.
Molecule read_molecule(const TomlTable& keys, const std::string& name, const KnownAtoms& known);

// The coordinates that the key `file` names, if it is there.
std::optional<Coordinates> read_file(const TomlTable& keys);

// What is wrong with coordinates that are another molecule's, or of atoms in another order: a bond not near
// its length. Empty: nothing. Of copies one after the other.
std::string wrong_bonds(const Molecule& molecule, const Vectors& x);

}  // namespace taut
