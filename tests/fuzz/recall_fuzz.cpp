// What a run remembers, changed at will, and then steps: it is refused, it fails as a simulation does, or it
// goes on. The input says which scene and what changes, so that a corpus outlasts a change of what is
// remembered: a byte for the scene, then changes of kChange bytes, each a kind, a place and eight bytes.

#include <array>
#include <cstring>

#include "harness.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace {

constexpr std::string_view kWater = R"(
hard_on = "eight waters"
build = {kind = "water", model = "tip3p", shape = "box", molecules = 8, density_g_cm3 = 0.98}
forcefield = {cutoff_nm = 0.2}
run = {dt_fs = 1, steps = 12, log_every = 4, temperature_k = 298.15}
)";

struct Remembered {
  taut::Scene scene;
  std::string memory;  // after eight of its twelve steps
};

Remembered remembered(const std::vector<std::string>& overrides) {
  Remembered all{taut::read_scene(taut::parse_toml_text(kWater, "water.toml"), "water.toml", overrides), {}};
  taut::Simulation simulation(all.scene);
  simulation.run({}, [&](long step) {
    if (step != 8) return;
    taut::Archive archive = taut::Archive::saving_to(all.memory);
    simulation.serialize(archive);
    simulation.stop();
  });
  return all;
}

const std::vector<Remembered>& all_remembered() {
  static const std::vector<Remembered> all = {
      remembered({"method.name=rattle"}),
      remembered({"method.name=newton", "run.thermostat=langevin"}),
      remembered({"method.name=baumgarte", "run.thermostat=rescaling", "run.thermostat_ps=0.1"}),
      remembered({"method.name=feedforward"}),
      remembered({"method.name=lincs"}),
      remembered({"method.name=shake", "run.remove_momentum_every=3"}),
      remembered({"method.name=penalty", "run.thermostat=langevin"}),
      remembered({"method.name=settle", "forcefield.precision=mixed"}),
  };
  return all;
}

constexpr std::size_t kChange = 1 + 4 + 8;

void change(std::string& memory, std::string_view how) {
  std::uint32_t place = 0;
  std::memcpy(&place, how.data() + 1, sizeof place);
  const std::size_t at = place % (memory.size() + 1);
  const std::string_view bytes = how.substr(5);
  switch (static_cast<unsigned char>(how[0]) % 5) {
    case 0:  // a number as a whole: most are eight bytes, at multiples of eight from the start or the end
      memory.replace(at / 8 * 8, std::min<std::size_t>(8, memory.size() - at / 8 * 8), bytes);
      break;
    case 1:
      memory.replace(memory.size() - std::min(memory.size(), at / 8 * 8 + 8),
                     std::min<std::size_t>(8, memory.size()), bytes);
      break;
    case 2:
      if (at < memory.size()) memory[at] = bytes[0];
      break;
    case 3:
      memory.erase(at, 8);
      break;
    default:
      memory.insert(at, bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return taut::read_or_refuse(data, size, [](std::string_view input) {
    if (input.empty()) return;
    const auto& all = all_remembered();
    const Remembered& mine = all[static_cast<unsigned char>(input[0]) % all.size()];
    std::string memory = mine.memory;
    for (input.remove_prefix(1); input.size() >= kChange; input.remove_prefix(kChange))
      change(memory, input.substr(0, kChange));
    taut::Simulation simulation(mine.scene);
    simulation.restore(memory);
    if (simulation.step() + 100 < mine.scene.run.steps) return;  // a step far back: too many to take
    try {
      simulation.run({});
    } catch (const taut::SimulationFailure&) {
      simulation.diagnose();
    }
  });
}
