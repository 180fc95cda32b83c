#include "systems/lammps/four_sites.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "systems/lammps/outer_forces.hpp"

namespace taut {
namespace {

bool same(double a, double b) {
  return std::abs(a - b) < 1e-9;
}

// True if each site is excluded from pairs with its own hydrogens, and from none with other atoms than its own.
bool excluded_at_home(const Scene& scene) {
  std::map<int, int> hydrogens;  // of each site
  for (const PairException& pair : scene.terms.nonbonded->exceptions)
    for (const auto& [site, other] : {std::pair{pair.i, pair.j}, {pair.j, pair.i}}) {
      if (!scene.system.is_site(site)) continue;
      const auto of = std::ranges::lower_bound(scene.system.sites, site, {}, &VirtualSite::atom);
      if (pair.charge_product != 0 || pair.epsilon != 0 ||
          std::ranges::find(of->parents, other, &VirtualSite::Parent::atom) == of->parents.end())
        return false;
      if (other != of->parents[0].atom) ++hydrogens[site];
    }
  return hydrogens.size() == scene.system.sites.size() &&
         std::ranges::all_of(hydrogens, [](const auto& of) { return of.second == 2; });
}

}  // namespace

std::optional<FourSiteWater> four_site_water(const Scene& scene) {
  const System& sys = scene.system;
  const auto& pairs = scene.terms.nonbonded;
  if (sys.sites.empty() || !pairs || !pairs->pme || pairs->lj_table || !excluded_at_home(scene)) return {};
  std::map<std::pair<int, int>, double> length;
  for (const RigidBond& bond : sys.bonds) length[std::minmax(bond.i, bond.j)] = bond.length;
  const auto held = [&](int i, int j) {
    const auto found = length.find({i, j});
    return found == length.end() ? 0 : found->second;
  };
  const std::vector<long> walls = walls_of_atoms(scene);
  FourSiteWater water{std::vector<int>(static_cast<std::size_t>(sys.atoms()), -1), 0, 0, 0, 0};
  for (const VirtualSite& site : sys.sites) {
    if (site.kind != VirtualSite::Kind::kAverage || site.parents.size() != 3) return {};
    const auto& [o, one, two] = std::tie(site.parents[0], site.parents[1], site.parents[2]);
    const int h = o.atom + 1, m = site.atom;
    if (std::min(one.atom, two.atom) != h || std::max(one.atom, two.atom) != h + 1 || !same(one.w, two.w))
      return {};
    if (pairs->charge[o.atom] != 0 || pairs->epsilon[m] != 0 || walls[static_cast<std::size_t>(m)] != 0)
      return {};
    const double oh = held(o.atom, h), hh = held(h, h + 1);
    if (!(oh > 0 && hh > 0) || !same(oh, held(o.atom, h + 1))) return {};
    const double angle = 2 * std::asin(hh / 2 / oh), distance = 2 * one.w * oh * std::cos(angle / 2);
    if (water.oh == 0) {
      water.oxygen = o.atom, water.oh = oh, water.angle = angle, water.distance = distance;
    } else if (!same(oh, water.oh) || !same(angle, water.angle) || !same(distance, water.distance)) {
      return {};
    }
    water.site_of[static_cast<std::size_t>(o.atom)] = m;
  }
  return water;
}

}  // namespace taut
