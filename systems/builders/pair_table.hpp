#pragma once

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Reads every [[pair]]: σ and ε of two kinds of atoms apart from mixing, or a table of energies in place of
// Lennard-Jones, also for atoms of one name among themselves. Makes a table of Lennard-Jones of them, in which other
// pairs mix by Lorentz and Berthelot as before; 1–4 exceptions keep their scale factors. Where tables leave no
// Lennard-Jones and no charge, Terms::nonbonded goes. Does nothing where there are none. Throws LocatedError.
void read_pair_table(const TomlTable& root, Scene& scene);

}  // namespace taut
