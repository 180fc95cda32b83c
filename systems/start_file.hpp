#pragma once

#include <filesystem>

#include "md/state.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// A start that ships with a scene, or the last state of a run, in TOML:
//     time_ps = 100.0
//     box_nm = [1.872, 1.872, 1.872]          only with a box: its edges, or its vectors in reduced form,
//                                             [ax, 0, 0, bx, by, 0, cx, cy, cz]
//     atoms = [ [x, y, z, vx, vy, vz], ... ]  [nm], [nm/ps], positions never wrapped
// Numbers are written so that they read back exactly.
// f is not there. Throws InputError with one line naming file, line and key.
State read_start(const std::filesystem::path& file);
State read_start(const TomlTable& keys);
State read_start(const toml::table& table, const std::filesystem::path& file);  // of a file parsed already

// Written aside and renamed. Throws OutsideError.
void write_start(const std::filesystem::path& file, const State& s);

}  // namespace taut
