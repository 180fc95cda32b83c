#pragma once

#include "md/box.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// box_nm = [x, y, z], a box's edges, or its vectors in reduced form, [ax, 0, 0, bx, by, 0, cx, cy, cz]. No
// box where it is not said.
Box read_box(const TomlTable& keys);

// box = "cube" (unless said) | "octahedron" | "dodecahedron": that shape, its first vector 1 long. They are
// the cells of points nearest to one of a lattice. Of the same width, a truncated octahedron takes 0.77 and a
// rhombic dodecahedron 0.71 of a cube's water.
Box read_shape(const TomlTable& keys);

}  // namespace taut
