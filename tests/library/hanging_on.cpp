// hanging_on SCENE.toml: the largest error of a bond that each constraint method lets pass in 200 steps.
#include <fmt/core.h>

#include <taut/simulation/simulation.hpp>
#include <taut/systems/scene/scene_file.hpp>

int main(int, char** argv) {
  for (const std::string method : {"penalty", "shake", "feedforward", "newton"}) {
    taut::Simulation simulation(taut::read_scene(argv[1], {"run.steps=200", "method.name=" + method}));
    fmt::print("{:<12} {:.1e}\n", method, simulation.run({}).max_rel_bond_error);
  }
}
