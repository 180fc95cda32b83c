#include "constraints/batch/bond_clusters.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "constraints/batch/cut_chains.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {
namespace {

// Returns numbers that are equal for two clusters if and only if the clusters are alike.
std::vector<double> key_of(const ClusterShape& shape) {
  std::vector<double> key = shape.inv_mass;
  for (const auto& [i, j, d] : shape.bonds) {
    key.push_back(i);
    key.push_back(j);
    key.push_back(d);
  }
  key.push_back(shape.left);
  key.push_back(shape.right);
  return key;
}

bool alike(const ClusterShape& a, const ClusterShape& b) {
  const auto same = [](const RigidBond& k, const RigidBond& l) {
    return k.i == l.i && k.j == l.j && k.length == l.length;
  };
  return a.left == b.left && a.right == b.right && a.inv_mass == b.inv_mass &&
         std::ranges::equal(a.bonds, b.bonds, same);
}

// Returns the largest number of bonds of a cluster whose shape is compared with others.
int most_bonds_of(const ClusterLimits& limits) {
  return limits.piece > 0 ? std::numeric_limits<int>::max()
                          : std::max(limits.most_bonds, limits.most_bonds_alike);
}

// Whether clusters are chains of a length that few others have: too few to fill the lanes, and each too short to fill
// them by itself.
bool is_odd(const ClusterBatch& batch, const ClusterLimits& limits) {
  return !limits.fill_lanes(batch.count) && batch.shape.bond_count() < limits.alike * limits.piece &&
         is_chain(batch.shape);
}

int count_odd_chains(const std::vector<ClusterBatch>& batches, const ClusterLimits& limits) {
  int count = 0;
  for (const ClusterBatch& batch : batches)
    if (is_odd(batch, limits)) count += batch.count;
  return count;
}

}  // namespace

int ClusterBatches::add(const ClusterShape& shape, const std::vector<int>& atoms,
                        const std::vector<int>& bonds) {
  if (batches.empty() || !alike(shape, batches[last_].shape)) {  // equal clusters often follow each other
    const auto [place, fresh] = batch_of_.try_emplace(key_of(shape), batches.size());
    if (fresh) batches.push_back({shape, 0, {}, {}});
    last_ = place->second;
  }
  ClusterBatch& batch = batches[last_];
  ++batch.count;
  batch.atoms.insert(batch.atoms.end(), atoms.begin(), atoms.end());
  batch.bonds.insert(batch.bonds.end(), bonds.begin(), bonds.end());
  return static_cast<int>(last_);
}

BondClusters find_clusters(const System& sys, const ClusterLimits& limits) {
  const std::vector<int> cluster = clusters_of_bonds(sys);
  std::vector<int> by_cluster(sys.bond_count());
  std::iota(by_cluster.begin(), by_cluster.end(), 0);
  const auto before = [&](int k, int l) { return cluster[k] < cluster[l]; };
  if (!std::ranges::is_sorted(by_cluster, before))
    std::stable_sort(by_cluster.begin(), by_cluster.end(), before);

  BondClusters found;
  ClusterBatches whole;
  std::vector<int> bonds, atoms;
  ClusterShape shape;
  for (auto begin = by_cluster.begin(); begin != by_cluster.end();) {
    const auto end =
        std::find_if(begin, by_cluster.end(), [&](int k) { return cluster[k] != cluster[*begin]; });
    bonds.assign(begin, end);
    begin = end;

    atoms.clear();
    for (int k : bonds) {
      atoms.push_back(sys.bonds[k].i);
      atoms.push_back(sys.bonds[k].j);
    }
    std::sort(atoms.begin(), atoms.end());
    atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
    const bool anchored =  // or in a virtual site
        std::any_of(atoms.begin(), atoms.end(), [&](int a) { return sys.inv_mass[a] == 0; });
    const bool meets_itself = sys.reach_of(atoms.front()) == Reach::kCluster;
    if (anchored || meets_itself || static_cast<int>(bonds.size()) > most_bonds_of(limits)) {
      found.rest.insert(found.rest.end(), bonds.begin(), bonds.end());
      continue;
    }

    shape.inv_mass.clear();
    shape.bonds.clear();
    for (int a : atoms) shape.inv_mass.push_back(sys.inv_mass[a]);
    const auto local = [&](int a) {
      return static_cast<int>(std::lower_bound(atoms.begin(), atoms.end(), a) - atoms.begin());
    };
    for (int k : bonds) {
      const auto [i, j] = std::minmax({local(sys.bonds[k].i), local(sys.bonds[k].j)});
      shape.bonds.push_back({i, j, sys.bonds[k].length});
    }
    whole.add(shape, atoms, bonds);
  }
  ClusterBatches pieces;
  const bool chains_of_many_lengths =
      limits.piece > 0 && count_odd_chains(whole.batches, limits) >= limits.alike;
  for (ClusterBatch& batch : whole.batches) {
    const int size = batch.shape.bond_count();
    const bool alike = size <= limits.most_bonds_alike && batch.count >= limits.alike;
    const bool whole_at_once = size <= limits.most_bonds || (alike && limits.fill_lanes(batch.count));
    if (chains_of_many_lengths && is_odd(batch, limits) && cut_chains(batch, {}, pieces, found.chains))
      continue;
    if (!whole_at_once && limits.piece > 0 && cut_chains(batch, limits.piece, pieces, found.chains)) continue;
    if (whole_at_once || alike)
      found.batches.push_back(std::move(batch));
    else
      found.rest.insert(found.rest.end(), batch.bonds.begin(), batch.bonds.end());
  }
  found.pieces = std::move(pieces.batches);
  std::sort(found.rest.begin(), found.rest.end());
  return found;
}

}  // namespace taut
