#pragma once

#include "systems/molecules/occupied_space.hpp"
#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// A [[wall]], which stands for two where it is a slit.
struct WallKeys {
  Slab slab;
  double sigma = 0, epsilon = 0;   // [nm], [kJ/mol]
  std::optional<double> cutoff;    // [nm]
  std::vector<std::string> atoms;  // names; empty: see make_walls()

  // Where atoms may be placed: nearer than this to a wall, 9–3 repels them [nm].
  Slab room() const { return {slab.axis, slab.lower + 0.75 * sigma, slab.upper - 0.75 * sigma}; }
};

// Reads every [[wall]]. Throws LocatedError.
std::vector<WallKeys> read_walls(const TomlTable& root);

// Adds the walls to a scene whose atoms are placed. A wall acts on the atoms it names; without names on all that
// have Lennard-Jones, or on all if none has; but on no anchor, and on no point that carries the mass of a rigid
// body. Throws LocatedError for a name that no atom has and an atom behind a wall.
void make_walls(const TomlTable& root, const std::vector<WallKeys>& walls, Scene& scene);

}  // namespace taut
