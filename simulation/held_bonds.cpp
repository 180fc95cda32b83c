#include "simulation/held_bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/errors.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {

HeldBonds::HeldBonds(const System& sys, const RunSettings& run)
    : all_bonds_(sys.bond_count()), metric_correction_(run.metric_correction) {
  const std::vector<int> cluster = clusters_of_bonds(sys);
  std::set<int> clusters;
  for (const std::array<int, 2>& atoms : run.tension_of) {
    const auto at = std::ranges::find_if(
        sys.bonds, [&](const RigidBond& b) { return b.i == atoms[0] && b.j == atoms[1]; });
    if (at == sys.bonds.end())
      throw InputError(fmt::format(
          "run.tension_of: the bond {}-{} follows from others and was dropped, so that it has no tension of "
          "its own; take another bond",
          atoms[0], atoms[1]));
    bonds_.push_back(static_cast<int>(at - sys.bonds.begin()));
    length_.push_back(at->length);
    clusters.insert(cluster[static_cast<std::size_t>(bonds_.back())]);
  }
  apart_ = clusters.size() == bonds_.size();
}

HeldTension HeldBonds::of(const Eigen::VectorXd& lambda, Projector* projector) const {
  const double share = 1 / static_cast<double>(bonds_.size());
  HeldTension mean{.tension = 0, .weight = apart_ && projector ? 0 : kUnknown};
  Eigen::VectorXd z = Eigen::VectorXd::Zero(all_bonds_);
  for (const int k : bonds_) z[k] = 1;
  if (apart_ && projector && !metric_correction_) projector->solve(z);  // each has a cluster of its own
  for (std::size_t n = 0; n < bonds_.size(); ++n) {
    mean.tension -= share * lambda[bonds_[n]] * length_[n];
    mean.weight += share * length_[n] * (metric_correction_ ? 1 : std::sqrt(z[bonds_[n]]));
  }
  return mean;
}

}  // namespace taut
