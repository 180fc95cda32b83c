#pragma once

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Applies keys of a scene to a System that OpenMM prepared: all of [forcefield], and gravity_nm_ps2, pulls
// and restraints of [build], which act in addition to the System's forces. A note reports each change of the
// model; the precision and the accuracy of PME are no part of it. Throws LocatedError, with the reason, for a
// key without effect on this System.
void override_forces(const TomlTable& root, Scene& scene);

}  // namespace taut
