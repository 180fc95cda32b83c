#include "systems/scene/net_pull.hpp"

#include <fmt/format.h>

#include <vector>

#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

// True for each molecule that cannot move off.
std::vector<bool> held_molecules(const Scene& scene, const std::vector<int>& molecule_of) {
  std::vector<bool> held(molecule_of.size(), false);
  const auto hold = [&](int atom) { held[molecule_of[atom]] = true; };
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (scene.system.is_anchor(a)) hold(a);
  for (const Restraint& restraint : scene.terms.restraints)
    if (restraint.k > 0 && restraint.side == 0 && restraint.axes == Vec3::Ones()) hold(restraint.atom);
  for (const SteeredAtom& steered : scene.terms.steered) hold(steered.atom);
  return held;
}

}  // namespace

std::string net_pull_message(const Scene& scene) {
  constexpr double kRounding = 1e-9;  // of the sum of the forces' sizes
  if (scene.terms.pulls.empty() || scene.run.remove_momentum_every > 0 || scene.foreign_fields()) return "";
  const std::vector<int> molecule_of = molecules(scene.system, scene.terms);
  const std::vector<bool> held = held_molecules(scene, molecule_of);
  Vec3 net = Vec3::Zero();
  double sizes = 0, mass = 0;
  for (const Pull& pull : scene.terms.pulls)
    if (!held[molecule_of[pull.atom]]) net += pull.force, sizes += pull.force.norm();
  for (const Wall& wall : scene.terms.walls) net[wall.axis] = 0;
  if (net.norm() <= kRounding * sizes) return "";
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (!held[molecule_of[a]]) mass += scene.system.mass[a];
  const double rate = net.norm() / mass;
  const bool rubs = scene.run.langevin() && scene.run.friction_per_ps > 0;
  std::string message = fmt::format(
      "pulls: {} add up to [{:.4g}, {:.4g}, {:.4g}] kJ/mol/nm, and nothing holds the molecules: their common "
      "centre moves off, by {:.3g} nm/ps²",
      scene.terms.pulls.size(), net.x(), net.y(), net.z(), rate);
  if (rubs)
    message += fmt::format(", until friction lets it go no faster than {:.3g} nm/ps",
                           rate / scene.run.friction_per_ps);
  if (scene.terms.pulls.size() > 1)
    message += " (in rows of a molecule with units, 0 names an atom of every unit, -1 its last atom alone)";
  return message;
}

}  // namespace taut
