#include "constraints/redundancy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <set>

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
  const std::vector<int> anywhere = dependent_at(sys, shaken, solver);
  for (int k : here) {
    const bool redundant = std::find(anywhere.begin(), anywhere.end(), k) != anywhere.end();
    (redundant ? found.redundant : found.degenerate).push_back(k);
  }
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
  System kept = sys;
  kept.bonds.clear();
  for (int k = 0; k < sys.bond_count(); ++k)
    if (std::find(bonds.begin(), bonds.end(), k) == bonds.end()) kept.bonds.push_back(sys.bonds[k]);
  return kept;
}

Eigen::VectorXd least_norm_multipliers(const System& full, const Vectors& x, const std::vector<int>& left_out,
                                       const Eigen::VectorXd& lambda) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(full.bond_count());  // the left-out bonds carry nothing yet
  std::vector<IndexPair> ties;
  for (int k = 0, kept = 0; k < full.bond_count(); ++k) {
    ties.push_back({full.bonds[k].i, full.bonds[k].j});
    if (std::find(left_out.begin(), left_out.end(), k) == left_out.end()) all[k] = lambda[kept++];
  }
  const std::vector<int> cluster_of = connected_components(full.atoms(), ties);
  std::set<int> overdetermined;
  for (int k : left_out) overdetermined.insert(cluster_of[full.bonds[k].i]);
  for (int cluster : overdetermined) {
    std::vector<int> bonds;
    std::map<int, int> row;  // of an atom in Jᵀ
    for (int k = 0; k < full.bond_count(); ++k) {
      const auto& [i, j, d] = full.bonds[k];
      if (cluster_of[i] != cluster) continue;
      bonds.push_back(k);
      row.try_emplace(i, 3 * static_cast<int>(row.size()));
      row.try_emplace(j, 3 * static_cast<int>(row.size()));
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
