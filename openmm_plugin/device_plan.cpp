#include "openmm_plugin/device_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "constraints/bond_graph.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "openmm_plugin/held_system.hpp"

namespace taut {
namespace {

// What the method says about each bond, and to the kernels.
struct DeviceLaw {
  std::vector<Gains> gains;  // m
  std::array<std::array<double, 3>, 4> guess;
  std::map<std::string, std::string> defines;
};

// The same extrapolation as Baumgarte::extrapolate().
std::array<std::array<double, 3>, 4> guess_of_order(int extrapolation) {
  constexpr std::array<double, 3> kOrders[] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
  std::array<std::array<double, 3>, 4> guess = {};
  for (int known = 1; known < 4; ++known) guess[known] = kOrders[std::min(extrapolation, known - 1)];
  return guess;
}

DeviceLaw law_of(const System& sys, const HoldSettings& settings) {
  const MethodOptions method = method_of(settings);
  const auto* const feedforward = method.get_if<Feedforward::Options>();
  const auto* const baumgarte = method.get_if<Baumgarte::Options>();
  if (!feedforward && !baumgarte)
    throw InputError(
        fmt::format("method \"{}\" does not run on this platform: take \"feedforward\" or \"baumgarte\", or "
                    "the platform CPU",
                    method.name()));
  const Baumgarte::Options options = feedforward ? *feedforward : *baumgarte;
  if (!options.in_lanes())
    throw InputError(
        "baumgarte's sweeps, its other damping than \"discrete\" and the gains \"hoomd\" do not run on this "
        "platform: take sweeps=0, damping=discrete and gains of another name, or the platform CPU");
  return {choose_gains(options.choice(), Damping::kDiscrete, sys, settings.h),
          guess_of_order(options.extrapolation),
          {{"TOLERANCE", fmt::format("(mixed) {:e}", options.tolerance)},
           {"MOST_SOLVES", fmt::format("{}", options.max_solves)}}};
}

// Those of many clusters, as they are found.
struct Growing {
  DeviceShape shape;
  std::vector<double> inv_masses;              // of the first
  std::vector<std::vector<int>> atoms, bonds;  // of each cluster, as the System numbers them
};

// A cluster's atoms, and its bonds between them: as the System numbers them, and within the cluster.
struct Cluster {
  std::vector<int> atoms, bonds;
  std::vector<std::array<int, 2>> ends;
};

Cluster cluster_of(const System& sys, const std::vector<int>& bonds) {
  Cluster cluster{{}, bonds, {}};
  for (const int k : bonds) cluster.atoms.insert(cluster.atoms.end(), {sys.bonds[k].i, sys.bonds[k].j});
  std::ranges::sort(cluster.atoms, {}, [&](int i) { return std::pair(sys.inv_mass[i] == 0, i); });
  cluster.atoms.erase(std::unique(cluster.atoms.begin(), cluster.atoms.end()), cluster.atoms.end());
  std::map<int, int> within;
  for (const int i : cluster.atoms) within.emplace(i, static_cast<int>(within.size()));
  for (const int k : bonds) cluster.ends.push_back({within[sys.bonds[k].i], within[sys.bonds[k].j]});
  return cluster;
}

std::vector<Cluster> clusters_of(const System& sys) {
  std::vector<Cluster> clusters;
  for (const auto& [first, of_cluster] : bonds_of_clusters(sys))
    clusters.push_back(cluster_of(sys, of_cluster));
  return clusters;
}

// Whether each atom moves or not: a group's plan depends on it.
std::vector<bool> moving(const std::vector<double>& inv_masses) {
  std::vector<bool> moves;
  for (const double w : inv_masses) moves.push_back(w != 0);
  return moves;
}

void add(std::vector<Growing>& all, const Cluster& cluster, const System& sys) {
  std::vector<double> inv_masses;
  for (const int i : cluster.atoms) inv_masses.push_back(sys.inv_mass[i]);
  auto found = std::ranges::find_if(all, [&](const Growing& one) {
    return one.shape.atoms == std::ssize(cluster.atoms) && one.shape.bonds == cluster.ends &&
           moving(one.inv_masses) == moving(inv_masses);
  });
  if (found == all.end()) {
    found = all.insert(all.end(), Growing{{}, inv_masses, {}, {}});
    found->shape.atoms = static_cast<int>(cluster.atoms.size());
    found->shape.bonds = cluster.ends;
  }
  found->atoms.push_back(cluster.atoms);
  found->bonds.push_back(cluster.bonds);
}

DeviceShape side_by_side(const Growing& grown, const System& sys, const DeviceLaw& law) {
  DeviceShape shape = grown.shape;
  shape.clusters = static_cast<int>(grown.atoms.size());
  for (int i = 0; i < shape.atoms; ++i)
    for (const std::vector<int>& cluster : grown.atoms) shape.atom.push_back(cluster[i]);
  const auto of_bonds = [&](std::vector<double>& to, const auto& number) {
    for (std::size_t k = 0; k < shape.bonds.size(); ++k)
      for (const std::vector<int>& cluster : grown.bonds) to.push_back(number(cluster[k]));
  };
  of_bonds(shape.length, [&](int k) { return sys.bonds[k].length; });
  of_bonds(shape.gains, [&](int k) { return 2 * law.gains[k].alpha; });
  of_bonds(shape.gains, [&](int k) { return law.gains[k].beta * law.gains[k].beta; });
  shape.guess = law.guess;
  const bool anchored = std::ranges::count(grown.inv_masses, 0.0) > 0;
  if (anchored || std::ssize(shape.bonds) > kMostBondsOfAThread)
    shape.group = plan_group(shape.bonds, grown.inv_masses);
  return shape;
}

}  // namespace

DevicePlan plan_for_device(const HeldBonds& held, const HoldSettings& settings) {
  const System sys = system_of(held);
  const DeviceLaw law = law_of(sys, settings);
  std::vector<Growing> all;
  std::vector<bool> is_free(sys.atoms());
  for (int i = 0; i < sys.atoms(); ++i) is_free[i] = held.masses[i] > 0;
  for (const Cluster& cluster : clusters_of(sys)) {
    add(all, cluster, sys);
    for (const int i : cluster.atoms) is_free[i] = false;
  }
  for (int i = 0; i < sys.atoms(); ++i)
    if (is_free[i]) add(all, {{i}, {}, {}}, sys);
  DevicePlan plan{{}, law.defines};
  for (const Growing& grown : all) plan.shapes.push_back(side_by_side(grown, sys, law));
  return plan;
}

}  // namespace taut
