#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "systems/scene.hpp"

namespace taut {

// Reads a scene, `overrides` ("run.dt_fs=2", "build.molecules=1000", "method.name=rattle") laid over the
// file's keys. Throws InputError with one line naming file, line and key.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

// The [run] and [method] sections alone, from overrides over defaults: for systems that come from elsewhere.
void apply_overrides(Scene& scene, const std::vector<std::string>& overrides);

}  // namespace taut
