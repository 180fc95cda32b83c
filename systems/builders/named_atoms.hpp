#pragma once

#include <string_view>
#include <vector>

#include "systems/scene/scene.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// The atoms that element `row` of a list names: by an index ("7", "-1": the last), a span ("10-29"), the name of atoms,
// or a list of these. Throws LocatedError.
std::vector<int> read_named_atoms(const TomlTable& keys, std::string_view key, std::size_t row,
                                  const Scene& scene);

}  // namespace taut
