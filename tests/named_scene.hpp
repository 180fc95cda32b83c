#pragma once

#include "systems/scene/scene_file.hpp"

namespace taut {

// One that comes with taut.
inline Scene scene_of(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_scene(find_scene(name), overrides);
}

}  // namespace taut
