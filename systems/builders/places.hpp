#pragma once

#include <map>
#include <string>
#include <vector>

#include "systems/builders/water_models.hpp"
#include "systems/molecules/read_molecule.hpp"

namespace taut {

// A part of the box.
struct Brick {
  Vec3 corner, edge;  // [nm]
};

// One [[place]].
struct Place {
  const Molecule* molecule = nullptr;
  bool equilibrated = false;  // water, which comes in boxes
  bool fills = false;         // with as many as there is room for
  bool lattice = false;
  long count = 0;
  std::optional<Brick> within{};  // or all the box
  Vectors centres{};              // [nm]
  Coordinates given{};            // of all atoms
  Vectors x{};                    // once they are placed

  double atoms() const { return static_cast<double>(count) * molecule->atoms(); }
};

// What is said, and taut's own water.
struct Library {
  std::map<std::string, Molecule> molecules;
  std::map<const Molecule*, const WaterModel*> water;
};

// [atom.NAME] and [molecule.NAME].
Library read_library(const TomlTable& root);

Place read_place(const TomlTable& keys, const Library& library);
// All [[place]]s. Throws LocatedError for more atoms than taut takes, and a molecule that none of them has.
std::vector<Place> read_places(const TomlTable& root, const Library& library);

// The box that [build] says, or one by a density, or of a file; or none.
Box box_of(const TomlTable& keys, const std::vector<Place>& places);

}  // namespace taut
