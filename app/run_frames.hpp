#pragma once

#include <filesystem>
#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// What the picture of a run's first and last frame is drawn from, a row an atom, a bond, an edge of the box or a wall,
// the nearest last: frame, what, place, other end [nm], the atom's size [nm] and kind. One sees along z, or along y
// where a wall is across z. Molecules are whole, their centres in the box. The last frame is that of final.start.toml;
// without that file there is the first alone.
std::string frames_csv(const Scene& scene, const std::filesystem::path& run);

}  // namespace taut
