#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/cluster_list.hpp"
#include "forcefield/pairs/pair_kernels.hpp"
#include "forcefield/terms.hpp"

namespace taut {

// The tables of TabulatedPairs by the kinds of a pair's atoms.
struct PairTables {
  int kinds = 0;                     // with one more, the last, for atoms without tables
  std::vector<const Spline*> table;  // kinds x kinds; null: none

  const Spline* of(int one, int two) const { return table[static_cast<std::size_t>(one * kinds + two)]; }
};
PairTables tables_by_kinds(const TabulatedPairs& pairs);

// Forces, energies and virials of a list's pairs by tables, one pair after the other, in double precision but for
// the positions; PairAtoms::type is an atom's kind. Results are as those of pair_kernels.hpp. Where two atoms are nearer
// to each other than their table begins, the energy is infinite, and forces and virials throw SimulationFailure, for
// which `clusters` name the atoms.
template <class T>
void add_table_forces(const PairTables& tables, const PairAtoms<T>& atoms, const AtomClusters& clusters,
                      const ClusterList& list, T* f);
template <class T>
double table_energy(const PairTables& tables, const PairAtoms<T>& atoms,
                    const ClusterList& list);  // [kJ/mol]
template <class T>
SixSums table_virial(const PairTables& tables, const PairAtoms<T>& atoms, const AtomClusters& clusters,
                     const ClusterList& list);

}  // namespace taut
