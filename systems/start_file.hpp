#pragma once

#include <filesystem>

#include "md/state.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// Reads a start in TOML: one that comes with a scene, or the last state of a run:
//     time_ps = 100.0
//     box_nm = [1.872, 1.872, 1.872]          with a box only: its edges, or its vectors in reduced form,
//                                             [ax, 0, 0, bx, by, 0, cx, cy, cz]
//     atoms = [ [x, y, z, vx, vy, vz], ... ]  [nm], [nm/ps], positions are not wrapped
// Numbers are written with all digits, so that they are read back exactly. f stays empty. Throws InputError,
// one line that names file, line and key.
State read_start(const std::filesystem::path& file);
State read_start(const TomlTable& keys);
State read_start(const toml::table& table, const std::filesystem::path& file);  // of a parsed file

// Writes the file under another name and renames it. Throws OutsideError.
void write_start(const std::filesystem::path& file, const State& s);

}  // namespace taut
