#pragma once

#include <filesystem>
#include <string>

#include "base/names.hpp"
#include "md/state.hpp"

namespace taut {

// The contents of a coordinate file.
struct Coordinates {
  Vectors x;  // [nm]
  Vectors v;  // [nm/ps]; empty if the file has none
  Box box;
  Names names;
  std::string note;  // a change that the user should know of; empty if none
};

// Reads a PDB file (.pdb, .ent): ATOM and HETATM of the first model, and CRYST1 (wwPDB format 3.3); or a GRO
// file (.gro) of GROMACS with any number of decimals. Skewed boxes are reduced (files/unit_cell.hpp). Throws
// InputError with one line that names file and line.
Coordinates read_coordinates(const std::filesystem::path& file);

}  // namespace taut
