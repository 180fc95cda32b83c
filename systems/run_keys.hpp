#pragma once

#include "systems/scene.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// Reads the keys of [run] into settings that hold the values below them: a file's over the defaults, overrides over
// the file's. A key that has no effect beside the other keys of [run] is refused.
void read_run(const TomlTable& table, RunSettings& run);

// What can be said only of a scene whose atoms are placed. `run` is its section [run].
// Gives the pulls their course in time; refuses a course without pulls.
void settle_pulls(const TomlTable& run, Scene& scene);

// Keeps or draws the velocities. `set_aside`: overrides have replaced the start or the velocities, so that keys of the
// file that belonged to them are ignored; other keys without effect are refused.
void settle_velocities(const TomlTable& run, bool set_aside, Scene& scene);

// Refuses a barostat where the scene has nothing for it to keep, or holds on to what it would move.
void check_barostat(const TomlTable& run, const Scene& scene);

}  // namespace taut
