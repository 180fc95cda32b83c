#include "systems/lammps/outer_forces.hpp"

#include <fmt/format.h>

#include "systems/lammps/special_bonds.hpp"

namespace taut {
namespace {

// "group NAME type 1 3" of the types whose first atoms have it.
std::string group(const std::string& name, const std::vector<int>& types, const auto& has) {
  std::string line = "group " + name + " type";
  for (std::size_t t = 0; t < types.size(); ++t)
    if (has(types[t])) line += fmt::format(" {}", t + 1);
  return line + "\n";
}

// A fix with its energy in the potential.
std::string fix(const std::string& name, const std::string& what) {
  return fmt::format("fix {0} {1}\nfix_modify {0} energy yes\n", name, what);
}

}  // namespace

std::vector<long> walls_of_atoms(const Scene& scene) {
  if (scene.terms.walls.size() > 29)
    refuse_for_lammps("more than 29 walls, since there are 32 groups of atoms");
  std::vector<long> all(static_cast<std::size_t>(scene.system.atoms()));
  for (std::size_t w = 0; w < scene.terms.walls.size(); ++w)
    for (const int a : scene.terms.walls[w].atoms) all[static_cast<std::size_t>(a)] |= 1L << w;
  return all;
}

Vec3 lower_corner(const Scene& scene) {
  if (!scene.start.box.periodic()) return scene.start.x.rowwise().minCoeff().array() - 1;
  Vec3 lower = Vec3::Zero();
  for (const Wall& one : scene.terms.walls)
    for (const Wall& other : scene.terms.walls)
      if (one.axis == other.axis && one.faces > other.faces)
        lower[one.axis] = (one.at + other.at - scene.start.box.edge[one.axis]) / 2;
  return lower;
}

LammpsOuterForces outer_forces(const Scene& scene, const std::vector<int>& types) {
  LammpsOuterForces to;
  if (scene.system.anchors() > 0) {
    to.moving = "moving";
    to.fixed = " fixed anchors";
    to.groups = group("anchors", types, [&](int a) { return scene.system.is_anchor(a); }) +
                "group moving subtract all anchors\ncompute warmth moving temp\nthermo_modify temp warmth\n";
  }
  if (const auto& g = scene.terms.gravity; g && !g->isZero(0))
    to.fixes += fix("gravity", fmt::format("{} gravity {:.17g} vector {:.17g} {:.17g} {:.17g}", to.moving,
                                           g->norm(), g->x(), g->y(), g->z()));
  const std::vector<long> before = walls_of_atoms(scene);
  for (std::size_t w = 0; w < scene.terms.walls.size(); ++w) {
    const auto& [axis, at, faces, sigma, epsilon, cutoff, atoms] = scene.terms.walls[w];
    constexpr double kFar = 1e6;  // [nm], where nothing of a wall is left
    const std::string name = fmt::format("before{}", w);
    to.groups +=
        group(name, types, [&, w](int a) { return (before[static_cast<std::size_t>(a)] >> w & 1) != 0; });
    to.fixes += fix(fmt::format("wall{}", w),
                    fmt::format("{} wall/lj93 {}{} {:.17g} {:.17g} {:.17g} {:.17g} units box{}", name,
                                "xyz"[axis], faces > 0 ? "lo" : "hi", at, epsilon, sigma,
                                cutoff.value_or(kFar), scene.start.box.periodic() ? " pbc yes" : ""));
  }
  return to;
}

}  // namespace taut
