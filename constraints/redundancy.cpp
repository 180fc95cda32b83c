#include "constraints/redundancy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <map>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "md/random.hpp"

namespace taut {
namespace {

constexpr double kNoPivot = 1e-8;  // of the diagonal

std::vector<int> dependent_at(const System& sys, const Vectors& x, DirectSolver& solver) {
  Vectors r(3, sys.bond_count());
  differences(sys, x, r);
  solver.factor(r, kNoPivot);
  return solver.dependent_bonds();
}

// Whether each of `count` bonds is among `listed`.
std::vector<char> marked(int count, const std::vector<int>& listed) {
  std::vector<char> is_listed(count, false);
  for (const int k : listed) is_listed[k] = true;
  return is_listed;
}

std::string list_of(const std::vector<int>& bonds, const System& sys) {
  constexpr std::size_t kShown = 4;
  std::string text;
  for (std::size_t n = 0; n < std::min(kShown, bonds.size()); ++n)
    text += fmt::format("{}{} ({}-{})", n == 0 ? "" : ", ", bonds[n], sys.bonds[bonds[n]].i,
                        sys.bonds[bonds[n]].j);
  if (bonds.size() > kShown) text += fmt::format(" and {} more", bonds.size() - kShown);
  return (bonds.size() == 1 ? "bond " : "bonds ") + text;
}

}  // namespace

Redundancy find_redundancy(const System& sys, const Vectors& x) {
  DirectSolver solver(sys);
  const std::vector<int> here = dependent_at(sys, x, solver);
  Redundancy found;
  if (here.empty()) return found;
  Random random(1);
  Vectors shaken = x;
  for (const auto& [i, j, d] : sys.bonds) {
    shaken.col(i) += 0.1 * d * random.normal_vector();
    shaken.col(j) += 0.1 * d * random.normal_vector();
  }
  const std::vector<char> anywhere = marked(sys.bond_count(), dependent_at(sys, shaken, solver));
  for (int k : here) (anywhere[k] ? found.redundant : found.degenerate).push_back(k);
  return found;
}

std::string explain(const Redundancy& redundancy, const System& sys) {
  if (!redundancy.degenerate.empty())
    return fmt::format(
        "{} cannot act in this placement (bonds in a line or a plane brace each other): bend the start, or "
        "drop {}",
        list_of(redundancy.degenerate, sys), redundancy.degenerate.size() == 1 ? "it" : "them");
  if (!redundancy.redundant.empty())
    return fmt::format("{} follow{} from other bonds: drop {}, or set run.redundant = \"drop\"",
                       list_of(redundancy.redundant, sys), redundancy.redundant.size() == 1 ? "s" : "",
                       redundancy.redundant.size() == 1 ? "it" : "them");
  return "";
}

System without(const System& sys, const std::vector<int>& bonds) {
  const std::vector<char> dropped = marked(sys.bond_count(), bonds);
  System kept = sys;
  kept.bonds.clear();
  for (int k = 0; k < sys.bond_count(); ++k)
    if (!dropped[k]) kept.bonds.push_back(sys.bonds[k]);
  return kept;
}

Eigen::VectorXd least_norm_multipliers(const System& full, const Vectors& x, const std::vector<int>& left_out,
                                       const Eigen::VectorXd& lambda) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(full.bond_count());  // the left-out bonds carry nothing yet
  const std::vector<char> dropped = marked(full.bond_count(), left_out);
  std::vector<IndexPair> ties;
  for (int k = 0, kept = 0; k < full.bond_count(); ++k) {
    ties.push_back({full.bonds[k].i, full.bonds[k].j});
    if (!dropped[k]) all[k] = lambda[kept++];
  }
  const std::vector<int> cluster_of = connected_components(full.atoms(), ties);
  std::map<int, std::vector<int>> overdetermined;  // the bonds of each cluster that had too many
  for (const int k : left_out) overdetermined[cluster_of[full.bonds[k].i]];
  for (int k = 0; k < full.bond_count(); ++k)
    if (const auto at = overdetermined.find(cluster_of[full.bonds[k].i]); at != overdetermined.end())
      at->second.push_back(k);
  for (const auto& [cluster, bonds] : overdetermined) {
    std::map<int, int> row;  // of an atom in Jᵀ
    for (const int k : bonds) {
      row.try_emplace(full.bonds[k].i, 3 * static_cast<int>(row.size()));
      row.try_emplace(full.bonds[k].j, 3 * static_cast<int>(row.size()));
    }
    Eigen::MatrixXd J_t =
        Eigen::MatrixXd::Zero(3 * static_cast<int>(row.size()), static_cast<int>(bonds.size()));
    for (int c = 0; c < J_t.cols(); ++c) {
      const auto& [i, j, d] = full.bonds[bonds[c]];
      const Vec3 r = x.col(j) - x.col(i);
      J_t.block<3, 1>(row[i], c) = -r;
      J_t.block<3, 1>(row[j], c) = r;
    }
    all(bonds) = J_t.completeOrthogonalDecomposition().solve(J_t * all(bonds)).eval();
  }
  return all;
}

}  // namespace taut
