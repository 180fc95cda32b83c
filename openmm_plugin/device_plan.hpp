#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "openmm_plugin/group_plan.hpp"
#include "openmm_plugin/held_dynamics.hpp"

// What a device needs to hold the bonds, planned on the host once a Context. C++17 without Eigen, as held_dynamics.hpp.
namespace taut {

// The largest cluster that one thread holds; larger ones, and those with an atom that never moves, have a group of
// threads.
constexpr int kMostBondsOfAThread = 6;

// Clusters with the same bonds between the same atoms; masses and lengths may differ. Free atoms are clusters of one
// atom without bonds. Arrays have one entry a cluster, side by side: [atom][cluster] and [bond][cluster].
struct DeviceShape {
  int atoms = 1;
  std::vector<std::array<int, 2>> bonds;  // atoms within the cluster
  int clusters = 0;
  std::vector<int> atom;       // as the System numbers them; the first of each cluster moves
  std::vector<double> length;  // [nm]
  std::vector<double> gains;   // 2α [1/ps] of all bonds, then their β² [1/ps²]
  // λ* = first λ₁ + second λ₂ + third λ₃ from the three steps before, where so many are known: 0, 1, 2, or 3.
  std::array<std::array<double, 3>, 4> guess = {};
  std::optional<GroupPlan> group;  // of a cluster that a group of threads holds
};

struct DevicePlan {
  std::vector<DeviceShape> shapes;
  std::map<std::string, std::string> defines;  // of the method, for the kernels
};

// Throws InputError for a method that devices do not have, with what to do.
DevicePlan plan_for_device(const HeldBonds& held, const HoldSettings& settings);

}  // namespace taut
