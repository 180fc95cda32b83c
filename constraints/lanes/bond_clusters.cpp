#include "constraints/lanes/bond_clusters.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace taut {
namespace {

// Of each bond: the smallest mobile atom of its cluster.
std::vector<int> cluster_of_bond(const System& sys) {
  std::vector<int> root(sys.atoms());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int a) {
    while (root[a] != a) a = root[a] = root[root[a]];
    return a;
  };
  for (const auto& [i, j, d] : sys.bonds) {
    if (sys.inv_mass[i] == 0 || sys.inv_mass[j] == 0) continue;
    const auto [low, high] = std::minmax({find(i), find(j)});
    root[high] = low;
  }
  std::vector<int> cluster(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k)
    cluster[k] = find(sys.inv_mass[sys.bonds[k].i] == 0 ? sys.bonds[k].j : sys.bonds[k].i);
  return cluster;
}

// All that makes two clusters the same, as numbers that can be compared.
std::vector<double> key_of(const ClusterShape& shape) {
  std::vector<double> key = shape.inv_mass;
  for (const auto& [i, j, d] : shape.bonds) {
    key.push_back(i);
    key.push_back(j);
    key.push_back(d);
  }
  return key;
}

}  // namespace

BondClusters find_clusters(const System& sys, const ClusterLimits& limits) {
  const std::vector<int> cluster = cluster_of_bond(sys);
  std::vector<int> by_cluster(sys.bond_count());
  std::iota(by_cluster.begin(), by_cluster.end(), 0);
  std::stable_sort(by_cluster.begin(), by_cluster.end(),
                   [&](int k, int l) { return cluster[k] < cluster[l]; });

  BondClusters found;
  std::map<std::vector<double>, std::size_t> batch_of;
  for (auto begin = by_cluster.begin(); begin != by_cluster.end();) {
    const auto end =
        std::find_if(begin, by_cluster.end(), [&](int k) { return cluster[k] != cluster[*begin]; });
    const std::vector<int> bonds(begin, end);
    begin = end;

    std::vector<int> atoms;
    for (int k : bonds) {
      atoms.push_back(sys.bonds[k].i);
      atoms.push_back(sys.bonds[k].j);
    }
    std::sort(atoms.begin(), atoms.end());
    atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
    const bool anchored =
        std::any_of(atoms.begin(), atoms.end(), [&](int a) { return sys.inv_mass[a] == 0; });
    if (anchored || static_cast<int>(bonds.size()) > std::max(limits.most_bonds, limits.most_bonds_alike)) {
      found.rest.insert(found.rest.end(), bonds.begin(), bonds.end());
      continue;
    }

    ClusterShape shape;
    for (int a : atoms) shape.inv_mass.push_back(sys.inv_mass[a]);
    const auto local = [&](int a) {
      return static_cast<int>(std::lower_bound(atoms.begin(), atoms.end(), a) - atoms.begin());
    };
    for (int k : bonds) {
      const auto [i, j] = std::minmax({local(sys.bonds[k].i), local(sys.bonds[k].j)});
      shape.bonds.push_back({i, j, sys.bonds[k].length});
    }
    const auto [place, fresh] = batch_of.try_emplace(key_of(shape), found.batches.size());
    if (fresh) found.batches.push_back({std::move(shape), 0, {}, {}});
    ClusterBatch& batch = found.batches[place->second];
    ++batch.count;
    batch.atoms.insert(batch.atoms.end(), atoms.begin(), atoms.end());
    batch.bonds.insert(batch.bonds.end(), bonds.begin(), bonds.end());
  }
  std::erase_if(found.batches, [&](const ClusterBatch& batch) {
    const bool fits = batch.shape.bond_count() <= limits.most_bonds || batch.count >= limits.alike;
    if (!fits) found.rest.insert(found.rest.end(), batch.bonds.begin(), batch.bonds.end());
    return !fits;
  });
  std::sort(found.rest.begin(), found.rest.end());
  return found;
}

}  // namespace taut
