#pragma once

#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/pair_kernels.hpp"
#include "forcefield/pairs/pair_problem.hpp"

namespace taut {

// Writes kinds and parameters of atoms by slot, for the kernels. Fillers have no interactions.
template <class T>
void load_parameters(const PairProblem& p, const AtomClusters& clusters, const Share& share,
                     std::vector<std::uint8_t>& kind, PairAtoms<T>& atoms) {
  for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot) {
    const int a = clusters.atom(slot);
    const bool filler = clusters.filler(slot);
    const auto unless_filler = [&](double value) { return filler ? T(0) : static_cast<T>(value); };
    kind[slot] = filler ? 0 : p.kind[a];
    atoms.charge[slot] = unless_filler(p.charge[a]);
    atoms.half_sigma[slot] = unless_filler(p.half_sigma[a]);
    atoms.two_sqrt_epsilon[slot] = unless_filler(p.two_sqrt_epsilon[a]);
    if (p.law.mixing == Mixing::kTable && !filler) atoms.type[slot] = static_cast<T>(p.table.type[a]);
  }
}

// Copies the table of Lennard-Jones types, if there is one. Fillers have the last type.
template <class T>
void load_table(const PairProblem& p, int slots, PairAtoms<T>& atoms) {
  if (p.law.mixing != Mixing::kTable) return;
  atoms.type.assign(slots, static_cast<T>(p.law.types - 1));
  const auto copy = [](const Eigen::MatrixXd& from, Aligned<T>& to) {
    to.resize(from.size());
    for (Eigen::Index k = 0; k < from.size(); ++k) to[k] = static_cast<T>(from.data()[k]);
  };
  copy(p.table.a, atoms.table_a);
  copy(p.table.b, atoms.table_b);
}

}  // namespace taut
