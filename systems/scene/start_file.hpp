#pragma once

#include <filesystem>

#include "md/box.hpp"
#include "md/state.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Reads a start file: the start that comes with a scene, or the last state of a run, in TOML:
//     time_ps = 100.0
//     box_nm = [1.872, 1.872, 1.872]          only with a box: see read_box()
//     atoms = [ [x, y, z, vx, vy, vz], ... ]  [nm], [nm/ps]; positions are never wrapped
// Numbers have all digits and read back exactly. Forces are not stored. Throws InputError with one line that
// names file, line and key.
State read_start(const std::filesystem::path& file);
State read_start(const TomlTable& keys);
State read_start(const toml::table& table, const std::filesystem::path& file);  // already parsed

// Reads box_nm = [x, y, z], the edges of a box, or [ax, 0, 0, bx, by, 0, cx, cy, cz], its vectors in reduced
// form. Returns no box where the key is absent.
Box read_box(const TomlTable& keys);

// Reads box = "cube" (the default), "octahedron" or "dodecahedron", and returns that shape with a first
// vector of length 1. At equal distance between images a truncated octahedron holds 0.77 and a rhombic
// dodecahedron 0.71 of a cube's water.
Box read_box_shape(const TomlTable& keys);

// Writes the file aside and renames it. Throws OutsideError.
void write_start(const std::filesystem::path& file, const State& s);

}  // namespace taut
