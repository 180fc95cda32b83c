#include "harness.hpp"
#include "systems/checkpoint.hpp"
#include "systems/scene_file.hpp"
#include "systems/simulation.hpp"
#include "systems/toml_reader.hpp"

namespace {

// Whose memory it may be: scene/water.toml of the corpus.
constexpr std::string_view kWater = R"(
hard_on = "eight waters"
build = {kind = "water", model = "tip3p", shape = "box", molecules = 8, density_g_cm3 = 0.98}
forcefield = {cutoff_nm = 0.2}
run = {dt_fs = 2, temperature_k = 298.15}
method = {name = "rattle"}
)";

void recall(std::string_view memory) {
  static const taut::Scene scene =
      taut::read_scene(taut::parse_toml_text(kWater, "water.toml"), "water.toml");
  taut::Simulation simulation(scene);
  simulation.recall(memory);
}

}  // namespace

// The body and the memory alone too: a checksum keeps changes from getting that far.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  taut::read_or_refuse(data, size, [](std::string_view bytes) { taut::read_checkpoint(bytes); });
  taut::read_or_refuse(data, size,
                       [](std::string_view bytes) { recall(taut::read_checkpoint_body(bytes).memory); });
  return taut::read_or_refuse(data, size, recall);
}
