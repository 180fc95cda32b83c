#pragma once

#include <filesystem>
#include <string>

#include "base/names.hpp"
#include "md/state.hpp"

namespace taut {

// The contents of a coordinate file: positions and names of the atoms, and the box and velocities if the file
// has them.
struct Coordinates {
  Vectors x;  // [nm]
  Vectors v;  // [nm/ps]; empty if the file has none
  Box box;
  Names names;
  std::string note;  // a message for the user about how it was read; may be empty
};

// Reads a PDB file (.pdb, .ent; ATOM and HETATM of the first model, CRYST1, wwPDB format 3.3) or a GRO file
// of GROMACS (.gro; any number of decimals). Skewed boxes are reduced (files/reduced_box.hpp). Throws
// InputError, one line with file and line.
Coordinates read_coordinates(const std::filesystem::path& file);

}  // namespace taut
