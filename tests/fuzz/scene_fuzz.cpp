#include <cmath>

#include "harness.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace {

// Counts that taut takes but that would take seconds to build: neither few nor beyond memory.
bool is_slow(const toml::table& scene) {
  const toml::table* build = scene["build"].as_table();
  if (build == nullptr) return false;
  double product = 1;
  for (const char* key : {"molecules", "chains", "rings", "beads"})
    product *= std::abs((*build)[key].value_or(1.0));
  return product > 2000 && product <= 5e6;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return taut::read_or_refuse(data, size, [](std::string_view text) {
    toml::table scene = taut::parse_toml_text(text, "fuzz.toml");
    if (!is_slow(scene)) taut::read_scene(std::move(scene), "fuzz.toml");
  });
}
