#include "constraints/redundancy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <map>

#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"

namespace taut {
namespace {

constexpr double kNoPivot = 1e-8;   // of A's diagonal
constexpr double kParallel = 1e-6;  // a dependent row of J keeps at most this fraction of its length

// Returns the bonds that depend on others at x, in the direct solver's order of elimination.
std::vector<int> dependent_at(const System& sys, const Vectors& x) {
  Vectors r(3, sys.bond_count());
  differences(sys, x, r);
  DirectSolver solver(sys);
  solver.factor(r, kNoPivot);
  return solver.dependent_bonds();
}

// Returns, for each of `count` bonds, whether `listed` contains it.
std::vector<char> marked(int count, const std::vector<int>& listed) {
  std::vector<char> is_listed(count, false);
  for (const int k : listed) is_listed[k] = true;
  return is_listed;
}

// Returns those of some bonds of one cluster that follow, at x, from the bonds before them in the list. Each
// row of J is orthogonalized against the rows before it (Gram–Schmidt, twice for accuracy).
std::vector<int> follow_from_those_before(const System& sys, const std::vector<int>& bonds,
                                          const Vectors& x) {
  std::map<int, int> place;  // of a movable atom in a row of J
  for (int k : bonds)
    for (int a : {sys.bonds[k].i, sys.bonds[k].j})
      if (sys.mass[a] > 0) place.try_emplace(a, 3 * static_cast<int>(place.size()));
  const auto width = static_cast<Eigen::Index>(3 * place.size());
  Eigen::MatrixXd basis(width, std::min<Eigen::Index>(width, std::ssize(bonds)));
  Eigen::Index rank = 0;
  std::vector<int> following;
  for (int k : bonds) {
    const auto& [i, j, d] = sys.bonds[k];
    Eigen::VectorXd row = Eigen::VectorXd::Zero(width);
    const Vec3 along = (x.col(j) - x.col(i)).normalized();
    if (sys.mass[i] > 0) row.segment<3>(place[i]) = -along;
    if (sys.mass[j] > 0) row.segment<3>(place[j]) = along;
    for (int pass = 0; pass < 2; ++pass)
      row -= basis.leftCols(rank) * (basis.leftCols(rank).transpose() * row).eval();
    if (rank < basis.cols() && row.norm() > kParallel)
      basis.col(rank++) = row.normalized();
    else
      following.push_back(k);
  }
  return following;
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
  const std::vector<int> here = dependent_at(sys, x);
  Redundancy found;
  if (here.empty()) return found;
  Random random(1);
  Vectors shaken = x;
  for (const auto& [i, j, d] : sys.bonds) {
    shaken.col(i) += 0.1 * d * random.normal_vector();
    shaken.col(j) += 0.1 * d * random.normal_vector();
  }
  // Bonds that are independent here are independent elsewhere, too. The dependent ones are redundant if they
  // follow from those elsewhere as well, whichever bonds were chosen as independent.
  const std::vector<int> cluster_of = clusters_of_bonds(sys);
  const std::vector<char> left_over = marked(sys.bond_count(), here);
  std::map<int, std::vector<int>> clusters;  // of each cluster: independent bonds, then the others
  for (const int k : here) clusters[cluster_of[k]];
  for (int k = 0; k < sys.bond_count(); ++k)
    if (const auto at = clusters.find(cluster_of[k]); at != clusters.end() && !left_over[k])
      at->second.push_back(k);
  for (const int k : here) clusters[cluster_of[k]].push_back(k);
  std::vector<char> follows(sys.bond_count(), false);
  for (const auto& [cluster, bonds] : clusters)
    for (const int k : follow_from_those_before(sys, bonds, shaken)) follows[k] = true;
  for (const int k : here) (follows[k] ? found.redundant : found.degenerate).push_back(k);
  for (int k = 0; k < sys.bond_count(); ++k)  // bonds that the direct solver found independent
    if (follows[k] && !left_over[k]) found.redundant.push_back(k);
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
  Eigen::VectorXd all = Eigen::VectorXd::Zero(full.bond_count());  // the left-out bonds begin with λ = 0
  const std::vector<char> dropped = marked(full.bond_count(), left_out);
  std::vector<IndexPair> ties;
  for (int k = 0, kept = 0; k < full.bond_count(); ++k) {
    ties.push_back({full.bonds[k].i, full.bonds[k].j});
    if (!dropped[k]) all[k] = lambda[kept++];
  }
  const std::vector<int> cluster_of = connected_components(full.atoms(), ties);
  std::map<int, std::vector<int>> overdetermined;  // the bonds of each overdetermined cluster
  for (const int k : left_out) overdetermined[cluster_of[full.bonds[k].i]];
  for (int k = 0; k < full.bond_count(); ++k)
    if (const auto at = overdetermined.find(cluster_of[full.bonds[k].i]); at != overdetermined.end())
      at->second.push_back(k);
  for (const auto& [cluster, bonds] : overdetermined) {
    std::map<int, int> row;  // the row of an atom in Jᵀ
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
