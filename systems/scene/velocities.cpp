#include "systems/scene/velocities.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr std::uint64_t kVelocityStream = 0x9e3779b97f4a7c15;

// Draws each component from a normal distribution of variance kT/m, and removes the total momentum if no
// external force acts, or it is asked for.
void draw_velocities(double temperature, std::uint64_t seed, Scene& scene) {
  Random random(seed ^ kVelocityStream);
  for (int a = 0; a < scene.system.atoms(); ++a)
    scene.start.v.col(a) =
        random.normal_vector() * std::sqrt(kBoltzmann * temperature * scene.system.inv_mass[a]);
  if (scene.closed() || scene.run.remove_momentum_every > 0) remove_momentum(scene.system, scene.start.v);
}

bool at_rest(const Scene& scene) {
  return scene.start.v.isZero(0);
}

}  // namespace

void give_velocities(Scene& scene) {
  const RunSettings& run = scene.run;
  const bool asked = run.velocities == "draw", kept = run.velocities == "keep";
  if (asked && run.temperature_k == 0)
    throw InputError(
        "run.velocities: to draw them takes a run.temperature_k above 0; or \"keep\" the start's");
  if (!asked && (kept || run.temperature_k == 0 || !(at_rest(scene) || scene.velocities_drawn))) return;
  draw_velocities(run.temperature_k, run.seed, scene);
  scene.velocities_drawn = true;
}

std::string describe_velocities(const Scene& scene) {
  if (scene.velocities_drawn) return fmt::format("drawn at {:g} K", scene.run.temperature_k);
  return at_rest(scene) ? "none, at rest" : "the start's";
}

}  // namespace taut
