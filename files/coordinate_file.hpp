#pragma once

#include <filesystem>
#include <string>

#include "base/names.hpp"
#include "md/state.hpp"

namespace taut {

// What a file of coordinates says of a system: where its atoms are, what they are called; a box, if it has
// one, and velocities.
struct Coordinates {
  Vectors x;  // [nm]
  Vectors v;  // [nm/ps]; empty where there are none
  Box box;
  Names names;
  std::string note;  // what the reader should know of how it was read; empty: nothing
};

// Of a PDB file (.pdb, .ent): ATOM and HETATM of its first model, CRYST1 (wwPDB format 3.3). Or of a GRO file
// (.gro) of GROMACS, of any number of decimals. Skewed boxes are reduced (files/reduced_box.hpp). Throws
// InputError with one line naming file and line.
Coordinates read_coordinates(const std::filesystem::path& file);

}  // namespace taut
