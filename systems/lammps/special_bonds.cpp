#include "systems/lammps/special_bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "systems/molecules/molecule.hpp"

namespace taut {
namespace {

constexpr double kEither = -1;  // a factor of what is zero anyway

// True where two atoms have Lennard-Jones by types, or a table of energies.
bool acts_by_table(const Terms& terms, int i, int j) {
  if (table_between(terms, i, j)) return true;
  const auto& nb = terms.nonbonded;
  if (!nb || !nb->lj_table) return false;
  const auto& [type, a, b] = *nb->lj_table;
  return a(type[i], type[j]) != 0 || b(type[i], type[j]) != 0;
}

}  // namespace

const Spline* table_between(const Terms& terms, int i, int j) {
  const auto& pairs = terms.tabulated_pairs;
  if (!pairs) return nullptr;
  for (const auto& [one, two, energy] : pairs->potentials)
    if (std::minmax(pairs->kind[i], pairs->kind[j]) == std::minmax(one, two)) return energy.get();
  return nullptr;
}

SpecialBonds special_bonds(const Scene& scene) {
  const auto& terms = scene.terms;
  std::map<std::pair<int, int>, std::pair<double, double>> said;  // factors of Lennard-Jones and Coulomb
  const auto& nb = terms.nonbonded;
  if (nb)
    for (const auto& e : nb->exceptions) {
      if (scene.system.is_site(e.i) || scene.system.is_site(e.j)) continue;
      const double epsilon = nb->lj_table ? 0 : std::sqrt(nb->epsilon[e.i] * nb->epsilon[e.j]);
      const bool by_table = acts_by_table(terms, e.i, e.j);
      const double charges = nb->charge[e.i] * nb->charge[e.j];
      if (nb->lj_table && e.epsilon != 0) refuse_for_lammps("scaled pairs 1-4 beside a table of pairs");
      said[std::minmax(e.i, e.j)] = {by_table      ? 0
                                     : epsilon > 0 ? e.epsilon / epsilon
                                                   : kEither,
                                     charges != 0 ? e.charge_product / charges : kEither};
    }
  if (const auto& wca = terms.wca) {
    std::set<std::pair<int, int>> fene;
    for (const Fene& spring : terms.fene) fene.insert(std::minmax(spring.i, spring.j));
    for (const auto& [i, j] : wca->exclusions) {
      said[std::minmax(i, j)].first = 0;
      if (fene.contains(std::minmax(i, j)))
        refuse_for_lammps(fmt::format("atoms {} and {} have FENE but do not repel", i, j));
    }
    for (const auto& pair : fene) said[pair] = {0, 0};  // fene has the repulsion itself
  }
  if (const auto& tables = terms.tabulated_pairs; tables && !nb)
    for (const auto& [i, j] : tables->exclusions) said[std::minmax(i, j)].first = 0;
  if (!nb && !terms.wca && !terms.tabulated_pairs) return {};
  Molecule all;
  all.system = scene.system;
  all.terms.bonds = terms.bonds;
  all.terms.fene = terms.fene;
  all.terms.tabulated_bonds = terms.tabulated_bonds;
  std::array<std::optional<double>, 3> lj, coulomb;
  const auto see = [](std::optional<double>& factor, double value, const NearPair& pair) {
    if (value == kEither) return;
    if (factor && std::abs(*factor - value) > 1e-9)
      refuse_for_lammps(fmt::format("pairs {} bonds apart are not all scaled alike (atoms {} and {})",
                                    pair.apart, pair.i, pair.j));
    factor = value;
  };
  const auto not_said = [&](int i, int j) {
    const bool lj_acts = !nb || nb->lj_table || nb->epsilon[i] * nb->epsilon[j] != 0;
    const bool coulomb_acts = nb && nb->charge[i] * nb->charge[j] != 0;
    return std::pair(lj_acts ? 1 : kEither, coulomb_acts ? 1 : kEither);
  };
  for (const NearPair& pair : list_near_pairs(all, 3)) {
    const auto found = said.find(std::minmax(pair.i, pair.j));
    const auto& [of_lj, of_coulomb] = found == said.end() ? not_said(pair.i, pair.j) : found->second;
    see(lj[pair.apart - 1], of_lj, pair);
    see(coulomb[pair.apart - 1], of_coulomb, pair);
    if (found != said.end()) said.erase(found);
  }
  if (!said.empty())
    refuse_for_lammps(
        fmt::format("atoms {} and {} have a pair force of their own, and are more than three bonds apart",
                    said.begin()->first.first, said.begin()->first.second));
  SpecialBonds factors;
  for (int k = 0; k < 3; ++k) factors.lj[k] = lj[k].value_or(1), factors.coulomb[k] = coulomb[k].value_or(1);
  return factors;
}

}  // namespace taut
