#pragma once

#include <memory>
#include <optional>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

class ForceField;

// The virial of the forces among atoms that never move: anchors, and virtual sites whose parents are all
// anchors. These forces do nothing, but would count in the pressure as if the anchors pressed on the box. It is
// computed anew only where these atoms or the box are set anew.
class FrozenPairs {
 public:
  FrozenPairs(const System& sys, const Terms& terms);
  ~FrozenPairs();
  FrozenPairs(FrozenPairs&&) noexcept;
  FrozenPairs& operator=(FrozenPairs&&) noexcept;

  // Zero where there are fewer than two such atoms [kJ/mol].
  const Eigen::Matrix3d& virial(const State& at);

 private:
  std::vector<int> atoms_;
  std::vector<Reach> reach_;    // of each of them
  std::optional<Terms> terms_;  // of these atoms alone
  State at_;                    // of these atoms, where the virial was computed
  Eigen::Matrix3d virial_ = Eigen::Matrix3d::Zero();
};

}  // namespace taut
