#include "forcefield/pairs/table_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace taut {
namespace {

// Differences of 32-bit positions are right modulo 2³².
double difference(double a, double b) {
  return a - b;
}
double difference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
double sum(double a, double b) {
  return a + b;
}
std::int32_t sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

struct Pair {
  int one, two;  // slots
  Vec3 d;        // from two to one [unit]
  double r;      // [nm]
  const Spline* table;
};

// Calls act(pair) for each pair that has a table and is within its range, or below.
template <class T, class Act>
void for_each_pair(const PairTables& tables, const PairAtoms<T>& atoms, const ClusterList& list,
                   const Act& act) {
  using Coordinate = typename PairPrecision<T>::Coordinate;
  const int atoms_of_row = row_atoms<T>();
  for (const PairRow& row : list.rows)
    for (int i = 0; i < atoms_of_row; ++i) {
      const int one = row.first + i, kind = static_cast<int>(atoms.type[one]);
      if (kind == tables.kinds - 1) continue;
      Coordinate x[3];
      for (int d = 0; d < 3; ++d)
        x[d] = sum(atoms.x[entry(one, d)], PairPrecision<T>::coordinate(row.shift[d] / atoms.unit));
      const auto meet = [&](int cluster, std::uint32_t mask) {
        for (int j = 0; j < kClusterAtoms; ++j) {
          if ((mask >> (4 * i + j) & 1) == 0) continue;
          const int two = kClusterAtoms * cluster + j;
          const Spline* table = tables.of(kind, static_cast<int>(atoms.type[two]));
          if (!table) continue;
          Vec3 d;
          for (int k = 0; k < 3; ++k) d[k] = difference(x[k], atoms.x[entry(two, k)]);
          const double r = std::sqrt(d.squaredNorm()) * atoms.unit;
          if (!(r > table->last())) act(Pair{one, two, d, r, table});
        }
      };
      for (int k = row.masked_begin; k < row.masked_end; ++k)
        meet(list.masked[k].cluster, list.masked[k].mask);
      for (int k = row.begin; k < row.end; ++k) meet(list.clusters[k], ~0u);
    }
}

// −(dE/dr)/r [kJ/mol/nm²]
double pull(const Pair& pair, const AtomClusters& clusters) {
  if (pair.table->covers(pair.r)) return -pair.table->at(pair.r).slope / pair.r;
  throw SimulationFailure(fmt::format(
      "atoms {} and {} are {:.6g} nm apart, nearer than their table {} begins, at {:g} nm; take a shorter "
      "step, or a table from a shorter distance on",
      clusters.atom(pair.one), clusters.atom(pair.two), pair.r, pair.table->name(), pair.table->first()));
}

}  // namespace

PairTables tables_by_kinds(const TabulatedPairs& pairs) {
  PairTables tables;
  for (const auto& [one, two, energy] : pairs.potentials)
    tables.kinds = std::max({tables.kinds, one + 1, two + 1});
  ++tables.kinds;  // that of atoms without tables
  tables.table.resize(static_cast<std::size_t>(tables.kinds) * static_cast<std::size_t>(tables.kinds));
  for (const auto& [one, two, energy] : pairs.potentials)
    for (const auto& [i, j] : {std::pair(one, two), std::pair(two, one)})
      tables.table[static_cast<std::size_t>(i * tables.kinds + j)] = energy.get();
  return tables;
}

template <class T>
void add_table_forces(const PairTables& tables, const PairAtoms<T>& atoms, const AtomClusters& clusters,
                      const ClusterList& list, T* f) {
  const int copies = row_atoms<T>();  // the first one takes all
  for_each_pair(tables, atoms, list, [&](const Pair& pair) {
    const Vec3 force = pull(pair, clusters) * pair.d;
    for (int d = 0; d < 3; ++d) {
      f[entry(pair.one, d, 3, copies)] += static_cast<T>(force[d]);
      f[entry(pair.two, d, 3, copies)] -= static_cast<T>(force[d]);
    }
  });
}

template <class T>
double table_energy(const PairTables& tables, const PairAtoms<T>& atoms, const ClusterList& list) {
  double energy = 0;
  for_each_pair(tables, atoms, list, [&](const Pair& pair) {
    energy +=
        pair.table->covers(pair.r) ? pair.table->at(pair.r).value : std::numeric_limits<double>::infinity();
  });
  return energy;
}

template <class T>
SixSums table_virial(const PairTables& tables, const PairAtoms<T>& atoms, const AtomClusters& clusters,
                     const ClusterList& list) {
  SixSums sums{};
  for_each_pair(tables, atoms, list, [&](const Pair& pair) {
    const Vec3 r = atoms.unit * pair.d, force = pull(pair, clusters) * r;
    for (int d = 0; d < 3; ++d) sums[d] += r[d] * force[d];
    sums[3] += r[0] * force[1];
    sums[4] += r[0] * force[2];
    sums[5] += r[1] * force[2];
  });
  return sums;
}

template void add_table_forces(const PairTables&, const PairAtoms<double>&, const AtomClusters&,
                               const ClusterList&, double*);
template void add_table_forces(const PairTables&, const PairAtoms<float>&, const AtomClusters&,
                               const ClusterList&, float*);
template double table_energy(const PairTables&, const PairAtoms<double>&, const ClusterList&);
template double table_energy(const PairTables&, const PairAtoms<float>&, const ClusterList&);
template SixSums table_virial(const PairTables&, const PairAtoms<double>&, const AtomClusters&,
                              const ClusterList&);
template SixSums table_virial(const PairTables&, const PairAtoms<float>&, const AtomClusters&,
                              const ClusterList&);

}  // namespace taut
