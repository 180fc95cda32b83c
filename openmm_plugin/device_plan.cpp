#include "openmm_plugin/device_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "constraints/batch/bond_clusters.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/feedforward.hpp"
#include "openmm_plugin/held_system.hpp"

namespace taut {
namespace {

using Guesses = std::array<std::array<double, 3>, 4>;

// The same extrapolation as Feedforward::extrapolate().
Guesses guesses_of(const Feedforward::Options& options) {
  constexpr std::array<double, 3> kOrders[] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
  Guesses guesses = {};
  for (int known = 1; known < 4; ++known)
    guesses[known] = kOrders[std::min(options.extrapolation, known - 1)];
  return guesses;
}

Guesses guesses_of(const Guess& wanted) {
  Guesses guesses = {};
  for (int known = 1; known < 4; ++known) {
    const auto [first, second] = limit_to_known(wanted, known);
    guesses[known] = {1 + first, second - first, -second};
  }
  return guesses;
}

// What the method says about each bond, and to the kernels.
struct Law {
  std::vector<Gains> gains;      // m, or empty
  std::vector<Guesses> guesses;  // m
  std::map<std::string, std::string> defines;
};

Law law_of(const System& sys, const HoldSettings& settings) {
  const MethodOptions method = method_of(settings);
  if (const auto* const options = method.get_if<Feedforward::Options>())
    return {{},
            std::vector(sys.bond_count(), guesses_of(*options)),
            {{"FEEDFORWARD", "1"},
             {"TOLERANCE", fmt::format("(mixed) {:e}", options->tolerance)},
             {"MOST_SOLVES", fmt::format("{}", options->max_solves)}}};
  const auto* const options = method.get_if<Baumgarte::Options>();
  if (!options)
    throw InputError(
        fmt::format("method \"{}\" does not run on this platform: take \"feedforward\" or \"baumgarte\", or "
                    "the platform CPU",
                    method.name()));
  if (options->sweeps > 0)
    throw InputError("baumgarte's sweeps do not run on this platform: take sweeps=0, or the platform CPU");
  const Damping damping = damping_named(options->damping);
  Law law{choose_gains(options->choice(), damping, sys, settings.h),
          {},
          {{"PASSES", fmt::format("{}", options->passes)}}};
  for (const Guess& guess : taut::guesses_of(sys, damping)) law.guesses.push_back(guesses_of(guess));
  if (damping == Damping::kDiscrete) law.defines.emplace("DISCRETE", "1");
  if (damping == Damping::kDiscrete || damping == Damping::kCentred) law.defines.emplace("CENTRED", "1");
  if (damping == Damping::kLagged) law.defines.emplace("LAGGED", "1");
  return law;
}

// Those of many clusters, as they are found.
struct Growing {
  DeviceShape shape;
  std::vector<std::vector<int>> atoms, bonds;  // of each cluster, as the System numbers them
};

bool alike(const DeviceShape& shape, const ClusterShape& other) {
  return shape.atoms == other.atoms() &&
         std::ranges::equal(shape.bonds, other.bonds, [](const std::array<int, 2>& a, const RigidBond& b) {
           return a[0] == b.i && a[1] == b.j;
         });
}

void add(std::vector<Growing>& all, const ClusterBatch& batch) {
  auto found = std::ranges::find_if(all, [&](const Growing& one) { return alike(one.shape, batch.shape); });
  if (found == all.end()) {
    found = all.insert(all.end(), Growing{});
    found->shape.atoms = batch.shape.atoms();
    for (const RigidBond& bond : batch.shape.bonds) found->shape.bonds.push_back({bond.i, bond.j});
  }
  const auto some = [](const std::vector<int>& of, int first, int count) {
    return std::vector<int>(of.begin() + first, of.begin() + first + count);
  };
  for (int c = 0; c < batch.count; ++c) {
    found->atoms.push_back(some(batch.atoms, c * batch.shape.atoms(), batch.shape.atoms()));
    found->bonds.push_back(some(batch.bonds, c * batch.shape.bond_count(), batch.shape.bond_count()));
  }
}

DeviceShape side_by_side(const Growing& grown, const System& sys, const Law& law) {
  DeviceShape shape = grown.shape;
  shape.clusters = static_cast<int>(grown.atoms.size());
  for (int i = 0; i < shape.atoms; ++i)
    for (const std::vector<int>& cluster : grown.atoms) shape.atom.push_back(cluster[i]);
  const auto of_bonds = [&](std::vector<double>& to, const auto& number) {
    for (std::size_t k = 0; k < shape.bonds.size(); ++k)
      for (const std::vector<int>& cluster : grown.bonds) to.push_back(number(cluster[k]));
  };
  of_bonds(shape.length, [&](int k) { return sys.bonds[k].length; });
  if (!law.gains.empty()) {
    of_bonds(shape.gains, [&](int k) { return 2 * law.gains[k].alpha; });
    of_bonds(shape.gains, [&](int k) { return law.gains[k].beta * law.gains[k].beta; });
  }
  if (!shape.bonds.empty()) shape.guess = law.guesses[grown.bonds.front().front()];
  return shape;
}

}  // namespace

DevicePlan plan_for_device(const HeldBonds& held, const HoldSettings& settings) {
  const System sys = system_of(held);
  const Law law = law_of(sys, settings);
  const BondClusters clusters =
      find_clusters(sys, {.most_bonds = kMostBondsOfAThread, .most_bonds_alike = kMostBondsOfAThread});
  if (!clusters.rest.empty()) {
    const RigidBond& bond = sys.bonds[clusters.rest.front()];
    throw InputError(
        fmt::format("the bond of atoms {} and {} belongs to a cluster of more than {} bonds, which this "
                    "platform does not "
                    "hold: constrain fewer bonds (constraints=HBonds), or take the platform CPU",
                    bond.i, bond.j, kMostBondsOfAThread));
  }
  std::vector<Growing> all;
  std::vector<bool> is_free(sys.atoms());
  for (int i = 0; i < sys.atoms(); ++i) is_free[i] = held.masses[i] > 0;
  for (const ClusterBatch& batch : clusters.batches) {
    add(all, batch);
    for (const int i : batch.atoms) is_free[i] = false;
  }
  Growing alone;
  for (int i = 0; i < sys.atoms(); ++i)
    if (is_free[i]) alone.atoms.push_back({i});
  if (!alone.atoms.empty()) all.push_back(alone);
  DevicePlan plan{{}, law.defines};
  for (const Growing& grown : all) plan.shapes.push_back(side_by_side(grown, sys, law));
  return plan;
}

}  // namespace taut
