#include "systems/openmm/import.hpp"

#include "systems/whole_molecules.hpp"

namespace taut {
namespace {

// "water.system.xml" -> "water"
std::string scene_name(const std::filesystem::path& file) {
  const std::filesystem::path stem = file.stem();
  return (stem.extension() == ".system" ? stem.stem() : stem).string();
}

}  // namespace

Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml) {
  OpenMMInput input = read_openmm(system_xml, state_xml);
  Scene scene;
  scene.name = scene_name(system_xml);
  scene.files = {system_xml, state_xml};
  scene.hard_on = "what OpenMM was given";
  scene.system = std::move(input.system);
  scene.terms = std::move(input.terms);
  scene.names = guessed_names(scene.system, scene.terms);
  scene.start = std::move(input.start);
  scene.notes = std::move(input.notes);
  scene.run.remove_momentum_every = input.remove_momentum_every;
  if (input.barostat) {
    scene.run.barostat = "monte-carlo";
    scene.run.pressure_bar = input.barostat->pressure_bar;
    scene.run.barostat_every = input.barostat->every;
  }
  scene.method = default_options(kUsualMethod);
  return scene;
}

OpenMMInput openmm_input(const Scene& scene) {
  return {scene.system, scene.terms, scene.start, scene.run.remove_momentum_every};
}

}  // namespace taut
