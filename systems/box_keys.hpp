#pragma once

#include "md/box.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// Reads box_nm: the edges of a box, [x, y, z], or its vectors in reduced form, [ax, 0, 0, bx, by, 0, cx, cy,
// cz]. Without the key there is no box.
Box read_box(const TomlTable& keys);

// Reads box = "cube" (the default) | "octahedron" | "dodecahedron", and returns that shape with a first
// vector of length
// 1. The shapes are Wigner–Seitz cells. At the same distance between images, a truncated octahedron has 0.77
//    and a rhombic dodecahedron 0.71 of the volume of a cube.
Box read_shape(const TomlTable& keys);

}  // namespace taut
