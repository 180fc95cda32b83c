#pragma once

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Reads the keys of [run], a file's with the overrides merged into them, into settings that hold the defaults. A key that
// has no effect beside the other keys of [run] is refused; one of the file that an override leaves without effect is set
// aside.
void read_run(const TomlTable& table, RunSettings& run);

// What can be said only of a scene whose atoms are placed. `run` is its section [run].
// Gives the pulls their course in time; refuses a course without pulls.
void settle_pulls(const TomlTable& run, Scene& scene);

// Finds the bonds of run.tension_of; refuses pairs of atoms that no rigid bond holds.
void settle_tensions(const TomlTable& run, Scene& scene);

// Keeps or draws the velocities. A run.temperature_k without effect is refused, unless it is the file's and overrides
// have replaced what it was for: the start (`another_start`), the thermostat or the velocities.
void settle_velocities(const TomlTable& run, bool another_start, Scene& scene);

// Refuses a barostat where the scene has nothing for it to keep, or holds on to what it would move.
void check_barostat(const TomlTable& run, const Scene& scene);

}  // namespace taut
