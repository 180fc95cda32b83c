#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "systems/scene/keys.hpp"

namespace taut {

// Returns the lines that describe keys: "run.dt_fs = 1 fs" and the meaning.
std::string key_text(const Key& key, int width);
nlohmann::ordered_json key_json(const Key& key);

// Returns the page of all keys in Markdown, systems/KEYS.md.
std::string keys_page(const std::vector<Key>& keys);

}  // namespace taut
