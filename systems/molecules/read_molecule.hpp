#pragma once

#include <map>
#include <string>

#include "files/coordinate_file.hpp"
#include "systems/molecules/molecule.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// The parameters of an atom, from [atom.NAME] or from a molecule's list.
struct AtomNumbers {
  AtomKind kind;
  double mass = 0;     // [u]
  double charge = 0;   // [e]
  double sigma = 1;    // [nm]
  double epsilon = 0;  // [kJ/mol]
};
using KnownAtoms = std::map<std::string, AtomNumbers>;

// Reads [atom.NAME].
AtomNumbers read_atom(const TomlTable& keys, const std::string& name);

// Reads [molecule.NAME]. Rows list atoms, counted from 0, and numbers. Rows and atoms are given for one
// repeat unit and apply to all. Bonds, springs or FENE springs must tie all atoms of a molecule. While keys
// are only described there are no atoms.
Molecule read_molecule(const TomlTable& keys, const std::string& name, const KnownAtoms& known);

// Reads the coordinates that the key `file` names, if it exists.
std::optional<Coordinates> read_file(const TomlTable& keys);

// Returns what is wrong with the coordinates of consecutive copies, or an empty string: a bond far from its
// length means another molecule, or atoms in another order.
std::string wrong_bonds(const Molecule& molecule, const Vectors& x);

}  // namespace taut
