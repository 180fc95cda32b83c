#include "studies/study_scene.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "simulation/redundant_bonds.hpp"
#include "simulation/simulation.hpp"

namespace taut {

Scene prepared_for_study(Scene given) {
  Scene scene = without_redundant_bonds(std::move(given));
  RunSettings& run = scene.run;
  if (run.langevin() || run.rescaling()) {
    scene.notes.push_back(fmt::format(
        "its thermostat ({}) is left out: energies and trajectories are compared, which it would change",
        run.langevin() ? "langevin" : "rescaling"));
    run.thermostat = "none";
    run.thermostat_ps = 0;
    run.temperature_course = {};
  }
  if (run.barostatted()) {
    scene.notes.push_back(fmt::format("its barostat ({}) is left out, as the thermostat is", run.barostat));
    run.barostat = "none";
  }
  if (run.minimise) {
    const Simulation relaxed(scene);
    scene.start = relaxed.state();
    scene.notes = relaxed.scene().notes;
    run.minimise = false;
  }
  return scene;
}

void refuse_without_effect(const char* study, const std::vector<std::string>& overrides) {
  for (const auto& override : overrides) {
    const std::string key = override.substr(0, override.find_first_of(" ="));
    const bool own = key == "method" || key.starts_with("method.");
    if (own || key == "run.log_every" || key.starts_with("run.checkpoint") ||
        key.starts_with("run.trajectory"))
      throw InputError(fmt::format("--set {}: no effect, taut {} {}", override, study,
                                   own ? "chooses methods and their settings itself" : "keeps no such file"));
  }
}

}  // namespace taut
