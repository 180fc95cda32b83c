#include "systems/builders/walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "base/nearest_name.hpp"
#include "systems/molecules/rigid_body.hpp"

namespace taut {
namespace {

constexpr double kNoPlane = std::numeric_limits<double>::infinity();

Slab read_slab(const TomlTable& wall) {
  const std::string axis = wall.choice("axis", {"x", "y", "z"}, "the axis that it is across");
  Slab slab{axis == "x" ? 0 : axis == "y" ? 1 : 2, -kNoPlane, kNoPlane};
  std::vector<double> between;
  wall.read("between_nm", between, {"a slit: its lower and its upper wall, as [0, 5]", "nm"});
  const bool above = wall.read("above_nm", slab.lower, {"one wall, with the atoms above it", "nm"});
  const bool below = wall.read("below_nm", slab.upper, {"one wall, with the atoms below it", "nm"});
  if (wall.describing()) return slab;
  if ((wall.has("between_nm") ? 1 : 0) + above + below != 1)
    wall.fail("axis", "expected one of between_nm, above_nm and below_nm beside it");
  if (above || below) return slab;
  if (between.size() != 2 || !(between[0] < between[1]))
    wall.fail("between_nm", "expected two numbers, the lower wall's place first, as [0, 5]");
  return {slab.axis, between[0], between[1]};
}

WallKeys read_wall(const TomlTable& keys) {
  WallKeys wall;
  wall.slab = read_slab(keys);
  wall.sigma = keys.get<double>("sigma_nm", {"σ of the wall with an atom", "nm", kPositive});
  wall.epsilon = keys.get<double>("epsilon_kj_mol", {"ε of the wall with an atom", "kJ/mol", kPositive});
  std::string potential = "9-3";
  keys.read(
      "potential", potential,
      {"ε(2/15 (σ/z)⁹ − (σ/z)³), or its repulsive part alone, up to z = 0.858 σ", {"9-3", "repulsive"}});
  keys.read("cutoff_nm", wall.cutoff, {"the force ends there", "nm", kPositive});
  keys.require_effect("cutoff_nm", potential == "9-3", "with potential = \"9-3\"");
  if (potential == "repulsive") wall.cutoff = Wall::repulsive_cutoff(wall.sigma);
  const std::size_t names = keys.size("atoms",
                                      "names of the atoms it acts on; not said: those with "
                                      "Lennard-Jones, or all if none has");
  for (std::size_t a = 0; a < names; ++a) {
    const auto name = keys.word("atoms", a);
    if (!name) keys.fail("atoms", a, "expected a name");
    wall.atoms.push_back(*name);
  }
  keys.reject_unknown();
  if (!keys.describing() && !(wall.room().lower < wall.room().upper))
    keys.fail("between_nm",
              fmt::format("the walls leave no room between them, expected more than 1.5 σ, {:g} nm",
                          1.5 * wall.sigma));
  return wall;
}

std::vector<int> atoms_before(const TomlTable& wall, const std::vector<std::string>& names,
                              const Scene& scene) {
  const auto& pairs = scene.terms.nonbonded;
  const auto& wca = scene.terms.wca;
  const bool some_have = !wca && pairs && (pairs->lj_table || !pairs->epsilon.isZero(0));
  const std::set<int> without =
      wca ? std::set<int>(wca->without.begin(), wca->without.end()) : std::set<int>();
  const auto& tables = scene.terms.tabulated_pairs;
  const auto has = [&](int a) {
    if (some_have) return pairs->epsilon[a] > 0;
    return !without.contains(a) && (!tables || tables->kind[a] >= 0);
  };
  std::vector<int> atoms;
  std::set<std::string> seen;
  for (int a = 0; a < scene.system.atoms(); ++a) {
    const std::string& name = scene.names.kinds[scene.names.kind[a]].atom;
    seen.insert(name);
    const bool named = std::ranges::find(names, name) != names.end();
    if (scene.system.is_anchor(a) || !(names.empty() ? has(a) && name != kFrameAtom : named)) continue;
    atoms.push_back(a);
  }
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!seen.contains(names[k]))
      wall.fail("atoms", k,
                fmt::format("no atom is called \"{}\"{}", names[k],
                            did_you_mean(names[k], {seen.begin(), seen.end()})));
  if (atoms.empty()) wall.fail("axis", "the wall acts on no atom that moves");
  return atoms;
}

}  // namespace

std::vector<WallKeys> read_walls(const TomlTable& root) {
  std::vector<WallKeys> walls;
  if (root.describing()) read_wall(root.section("wall"));
  const std::size_t count = root.size("wall", {"planes that push atoms away, a section [[wall]] each"});
  for (std::size_t k = 0; k < count; ++k) walls.push_back(read_wall(root.section("wall", k)));
  return walls;
}

void make_walls(const TomlTable& root, const std::vector<WallKeys>& walls, Scene& scene) {
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const WallKeys& wall = walls[k];
    const TomlTable own = root.section("wall", k);
    if (scene.start.box.periodic() && !(wall.slab.upper - wall.slab.lower < kNoPlane))
      own.fail("axis", fmt::format("in a box a wall needs another one that faces it: between_nm along {}",
                                   "xyz"[wall.slab.axis]));
    const std::vector<int> atoms = atoms_before(own, wall.atoms, scene);
    for (const int a : atoms)
      if (!wall.slab.holds(scene.start.x.col(a)))
        own.fail("axis", fmt::format("atom {} starts behind the wall, at {} = {:.4g} nm", a,
                                     "xyz"[wall.slab.axis], scene.start.x(wall.slab.axis, a)));
    for (const auto& [at, faces] : {std::pair{wall.slab.lower, 1}, std::pair{wall.slab.upper, -1}})
      if (at != faces * -kNoPlane)
        scene.terms.walls.push_back(
            {wall.slab.axis, at, faces, wall.sigma, wall.epsilon, wall.cutoff, atoms});
  }
}

}  // namespace taut
