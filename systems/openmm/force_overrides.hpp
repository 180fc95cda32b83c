#pragma once

#include "systems/scene.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// Lays keys of a scene over the forces of a System that OpenMM prepared: all of [forcefield], and of [build]
// gravity_nm_ps2, pulls and restraints, which act besides the System's own. A scene's note says each change
// of the model; precision, and how closely PME sums, do not change it. Throws LocatedError for a key that
// cannot act on this System, with the reason.
void override_forces(const TomlTable& root, Scene& scene);

}  // namespace taut
