#include "simulation/held_bonds.hpp"

#include <cmath>
#include <map>
#include <set>

#include "constraints/bond_graph.hpp"
#include "md/bonds_by_atoms.hpp"

namespace taut {

HeldBonds::HeldBonds(const System& full, const System& sys, const RunSettings& run)
    : all_kept_(sys.bond_count()), metric_correction_(run.metric_correction) {
  const BondsByAtoms among_all = bonds_by_atoms(full), among_kept = bonds_by_atoms(sys);
  const std::vector<int> cluster = clusters_of_bonds(full);
  std::map<int, int> lost;  // bonds of each cluster
  for (const int of : cluster) ++lost[of];
  for (const int of : clusters_of_bonds(sys)) --lost[of];
  std::set<int> clusters;
  have_weight_ = true;
  for (const auto& [i, j] : run.tension_of) {
    bonds_.push_back(among_all.at(in_order(i, j)));
    length_.push_back(full.bonds[bonds_.back()].length);
    const int of = cluster[static_cast<std::size_t>(bonds_.back())];
    have_weight_ = have_weight_ && lost[of] == 0 && clusters.insert(of).second;
    if (have_weight_) kept_.push_back(among_kept.at(in_order(i, j)));
  }
}

HeldTension HeldBonds::of(const Eigen::VectorXd& lambda, Projector* projector) const {
  const double share = 1 / static_cast<double>(bonds_.size());
  const bool weighs = have_weight_ && projector;
  HeldTension mean{.tension = 0, .weight = weighs ? 0 : kUnknown};
  for (std::size_t n = 0; n < bonds_.size(); ++n) mean.tension -= share * lambda[bonds_[n]] * length_[n];
  if (!weighs) return mean;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(all_kept_);
  for (const int k : kept_) z[k] = 1;
  if (!metric_correction_) projector->solve(z);  // each has a cluster of its own
  for (std::size_t n = 0; n < kept_.size(); ++n)
    mean.weight += share * length_[n] * (metric_correction_ ? 1 : std::sqrt(z[kept_[n]]));
  return mean;
}

}  // namespace taut
