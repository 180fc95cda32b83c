#include "studies/crosscheck_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "constraints/methods/newton.hpp"
#include "forcefield/force_field.hpp"

namespace taut {
namespace {

constexpr double kNudge = 1e-10;     // [nm]
constexpr double kSaturated = 0.01;  // apart by more, chaos has done its work [nm]
constexpr long kShort = 200;         // steps of runs that settle one question

double at_float(double length) {
  return static_cast<double>(static_cast<float>(length));
}

// The lengths OpenMM holds, told from its positions: ours, or the floats nearest to ours.
std::vector<RigidBond> lengths_held(const System& sys, const Vectors& x, int& rounded) {
  std::vector<RigidBond> bonds = sys.bonds;
  for (auto& [i, j, length] : bonds) {
    const double now = (x.col(j) - x.col(i)).norm(), nearest = at_float(length);
    if (std::abs(now - nearest) > 1e-10 * length || std::abs(nearest - length) < 1e-9 * length) continue;
    length = nearest;
    ++rounded;
  }
  return bonds;
}

// newton and the twin, both from a scene's start.
double apart_after(const Stage& stage, const Scene& scene, long steps) {
  Simulation simulation(scene);
  const auto twin = stage.twin({});
  twin->set(simulation.state());
  simulation.run({});
  advance(*twin, steps);
  return most_apart(simulation.state().x, twin->state().x);
}

}  // namespace

StartDifference compare_start(const Stage& stage, OpenMMTwin& twin) {
  ForceField forces(stage.scene.system, stage.scene.start.box, stage.scene.terms);
  State s = stage.scene.start;
  ForceField::Evaluation evaluation;
  forces.evaluate(stage.scene.system, s, evaluation);
  Vectors theirs;
  const double energy = twin.forces_at(s.x, theirs);
  Vectors difference = s.f - theirs;
  for (int a = 0; a < stage.scene.system.atoms(); ++a)
    if (stage.scene.system.mass[a] == 0) difference.col(a).setZero();  // no force moves an anchor
  return {
      .energy = forces.potential(s, evaluation),
      .openmm_energy = energy,
      .force_rms = std::sqrt(s.f.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, s.f.size()))),
      .force_difference = difference.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(),
      .terms = forces.energies(s, evaluation)};
}

OpenMMBonds openmm_bonds(const Stage& stage, double worst_seen) {
  OpenMMBonds result{.worst = worst_seen};
  if (stage.scene.system.bonds.empty()) return result;
  const auto twin = stage.twin({});
  twin->step(1);
  Scene scene = stage.scene;
  const std::vector<RigidBond> held = lengths_held(scene.system, twin->state().x, result.rounded);
  if (result.rounded == 0) return result;
  result.steps = scene.run.steps = std::min(stage.parting, kShort);
  scene.run.log_every = result.steps;
  result.apart_as_given = apart_after(stage, scene, result.steps);
  scene.system.bonds = held;
  result.apart_with_theirs = apart_after(stage, scene, result.steps);
  return result;
}

static State nudged(const Scene& scene) {
  Random random(scene.run.seed);
  State s = scene.start;
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (scene.system.mass[a] > 0) s.x.col(a) += kNudge * random.unit_vector();
  return s;
}

Track nudged_run(const Stage& stage, const Contestant& contestant, const Against& against) {
  Stage moved = stage;
  moved.scene.start = nudged(stage.scene);
  return follow(moved, {contestant.name + " moved 1e-10", contestant.method}, stage.parting, against).track;
}

Track nudged_run(const Stage& stage, const Against& against) {
  const auto twin = stage.twin(stage.on_platform());
  twin->set(nudged(stage.scene));
  return follow(stage, "openmm moved 1e-10", *twin, stage.parting, against).track;
}

Chaos chaos_of(const Track& nudged) {
  Chaos chaos;
  Slope rate;
  for (const Sample& s : nudged.samples) {
    if (s.apart < 0 || s.apart > kSaturated) break;
    chaos.growth = std::max(chaos.growth, s.apart / kNudge);
    chaos.steps = s.step;
  }
  for (const Sample& s : nudged.samples)
    if (s.apart > 0 && 2 * s.step >= chaos.steps && s.step <= chaos.steps) rate.add(s.t, std::log(s.apart));
  chaos.rate = {rate.value(), rate.standard_error()};
  return chaos;
}

Leapfrog compare_leapfrog(const Stage& stage) {
  Leapfrog found{.steps = std::min(stage.parting, 20L)};
  const auto twin = stage.twin({}), verlet = stage.twin({.integrator = TwinIntegrator::kVerlet});
  advance(*twin, found.steps);
  advance(*verlet, found.steps);
  const State ours = twin->state(), theirs = verlet->state();
  found.positions = most_apart(ours.x, theirs.x);
  found.velocities = most_apart(ours.v, theirs.v);
  found.velocities_kept = most_apart(ours.v, verlet->kept_velocities());
  return found;
}

}  // namespace taut
