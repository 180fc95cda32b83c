#pragma once

#include <map>
#include <string>
#include <vector>

#include "systems/builders/water_models.hpp"
#include "systems/molecules/read_molecule.hpp"

namespace taut {

// A rectangular region of the box.
struct BoxRegion {
  Vec3 corner, edge;  // [nm]
};

// One [[place]]: copies of a molecule.
struct Placement {
  const Molecule* molecule = nullptr;
  bool equilibrated = false;  // taken from a box of equilibrated water
  bool fills = false;         // as many copies as fit
  bool lattice = false;
  long count = 0;
  std::optional<BoxRegion> within{};  // a region, or the whole box
  Vectors centres{};                  // [nm]
  Coordinates given{};                // coordinates of all atoms
  Vectors x{};                        // 3 × atoms, after placing

  // True for water that is cut from a box of equilibrated water.
  bool is_cut() const { return equilibrated && given.x.cols() == 0 && centres.cols() == 0; }
  double atoms() const { return static_cast<double>(count) * molecule->atoms(); }
};

// Molecules that the scene defines, and taut's water models.
struct Library {
  std::map<std::string, Molecule> molecules;
  std::map<const Molecule*, const WaterModel*> water;
};

// Reads [atom.NAME] and [molecule.NAME].
Library read_library(const TomlTable& root);

Placement read_placement(const TomlTable& keys, const Library& library);
// Reads all [[place]]s. Throws LocatedError for too many atoms, and for a molecule that no place uses.
std::vector<Placement> read_placements(const TomlTable& root, const Library& library);

// Returns the box of [build]: explicit, from a density, or from a file; or none.
Box box_of(const TomlTable& keys, const std::vector<Placement>& placements);

}  // namespace taut
