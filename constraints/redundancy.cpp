#include "constraints/redundancy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <iterator>
#include <map>

#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/bond_graph.hpp"
#include "constraints/direct_solver.hpp"

namespace taut {
namespace {

constexpr double kNoPivot = 1e-8;   // of A's diagonal
constexpr double kParallel = 1e-6;  // a dependent row of J keeps at most this fraction of its length

// Returns the bonds that depend on others at x, in the direct solver's order of elimination.
std::vector<int> dependent_at(const System& sys, const Vectors& x) {
  Vectors r(3, sys.bond_count());
  bond_vectors(sys, x, r);
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
    sys.for_each_bearer(sys.bonds[k], [&](int a, double) {
      if (sys.mass[a] > 0) place.try_emplace(a, 3 * static_cast<int>(place.size()));
    });
  const auto width = static_cast<Eigen::Index>(3 * place.size());
  Eigen::MatrixXd basis(width, std::min<Eigen::Index>(width, std::ssize(bonds)));
  Eigen::Index rank = 0;
  std::vector<int> following;
  for (int k : bonds) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(width);
    const Vec3 along = sys.along(sys.bonds[k], x).normalized();
    sys.for_each_bearer(sys.bonds[k], [&](int a, double c) {
      if (sys.mass[a] > 0) row.segment<3>(place[a]) += c * along;
    });
    for (int pass = 0; pass < 2; ++pass)
      row -= basis.leftCols(rank) * (basis.leftCols(rank).transpose() * row).eval();
    if (rank < basis.cols() && row.norm() > kParallel)
      basis.col(rank++) = row.normalized();
    else
      following.push_back(k);
  }
  return following;
}

// A row of J for each of some bonds, of unit vectors along them: how displacements of their mobile atoms along the
// columns of `span` change the lengths. place: of each mobile atom.
Eigen::MatrixXd length_rows(const System& sys, const std::vector<int>& bonds, const std::map<int, int>& place,
                            const Eigen::MatrixXd& span, const Vectors& x) {
  const Eigen::Index dims = span.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::ssize(bonds), dims * std::ssize(place));
  for (Eigen::Index b = 0; b < rows.rows(); ++b) {
    const Eigen::RowVectorXd along = sys.along(sys.bonds[bonds[b]], x).normalized().transpose() * span;
    sys.for_each_bearer(sys.bonds[bonds[b]], [&](int a, double c) {
      if (sys.mass[a] > 0) rows.block(b, dims * place.at(a), 1, dims) += c * along;
    });
  }
  return rows;
}

struct AtomsOfBonds {
  std::vector<int> all;      // each once
  std::map<int, int> place;  // of the mobile ones, counted from 0
};
AtomsOfBonds atoms_of(const System& sys, const std::vector<int>& bonds) {
  AtomsOfBonds atoms;
  for (const int k : bonds) sys.for_each_bearer(sys.bonds[k], [&](int a, double) { atoms.all.push_back(a); });
  std::ranges::sort(atoms.all);
  atoms.all.erase(std::unique(atoms.all.begin(), atoms.all.end()), atoms.all.end());
  for (const int a : atoms.all)
    if (sys.mass[a] > 0) atoms.place.try_emplace(a, static_cast<int>(atoms.place.size()));
  return atoms;
}

// Those of some independent bonds whose rows of J add up to the row of bond k.
std::vector<int> bonds_that_imply(const System& sys, const std::vector<int>& bonds, int k, const Vectors& x) {
  constexpr double kNone = 1e-6;
  std::vector<int> with_k = bonds;
  with_k.push_back(k);
  const Eigen::MatrixXd rows =
      length_rows(sys, with_k, atoms_of(sys, with_k).place, Eigen::Matrix3d::Identity(), x);
  const Eigen::VectorXd shares = rows.topRows(std::ssize(bonds))
                                     .transpose()
                                     .completeOrthogonalDecomposition()
                                     .solve(rows.bottomRows(1).transpose());
  std::vector<int> implying;
  for (std::size_t b = 0; b < bonds.size(); ++b)
    if (std::abs(shares[static_cast<Eigen::Index>(b)]) > kNone) implying.push_back(bonds[b]);
  return implying;
}

// The plane or the space that points lie in, as columns; fewer than two for a line.
Eigen::MatrixXd span_of(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(centred, Eigen::ComputeFullU);
  const auto& extent = svd.singularValues();
  return svd.matrixU().leftCols((extent.array() > 1e-6 * extent[0]).count());
}

// Whether bond k, which follows from those of a circuit at x, does so wherever they let its atoms move, and they do let
// it change its shape. It moves by a tenth of a bond in a random direction that they allow to first order, and is then
// brought back to their lengths by least squares.
bool follows_along_motion(const System& sys, const std::vector<int>& circuit, int k, const Vectors& x) {
  const AtomsOfBonds atoms = atoms_of(sys, circuit);
  const Eigen::MatrixXd span = span_of(x(Eigen::all, atoms.all));
  if (span.cols() < 2) return false;
  const auto move = [&](const Eigen::VectorXd& by, Vectors& moved) {
    for (const auto& [a, at] : atoms.place) moved.col(a) += span * by.segment(span.cols() * at, span.cols());
  };
  const auto length = [&](int bond, const Vectors& at) { return sys.along(sys.bonds[bond], at).norm(); };
  const double d = length(k, x);
  Random random(1);
  Eigen::VectorXd motion(span.cols() * std::ssize(atoms.place));
  for (double& number : motion) number = random.normal_vector().x();
  const Eigen::MatrixXd held = length_rows(sys, circuit, atoms.place, span, x);
  motion -= held.completeOrthogonalDecomposition().solve(held * motion).eval();
  Vectors moved = x;
  move(0.1 * d / std::max(motion.cwiseAbs().maxCoeff(), 1e-3) * motion, moved);
  Eigen::VectorXd off(std::ssize(circuit));
  for (int n = 0; n < 50; ++n) {
    for (Eigen::Index b = 0; b < off.size(); ++b) off[b] = length(circuit[b], x) - length(circuit[b], moved);
    if (off.cwiseAbs().maxCoeff() < 1e-12 * d) break;
    move(length_rows(sys, circuit, atoms.place, span, moved).completeOrthogonalDecomposition().solve(off),
         moved);
  }
  if (!(off.cwiseAbs().maxCoeff() < 1e-9 * d) || !(std::abs(length(k, moved) - d) < 1e-8 * d)) return false;
  for (const int a : atoms.all)
    for (const int b : atoms.all)
      if (std::abs((moved.col(a) - moved.col(b)).norm() - (x.col(a) - x.col(b)).norm()) > 1e-3 * d)
        return true;
  return false;
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
  for (const RigidBond& bond : sys.bonds)
    sys.for_each_bearer(bond,
                        [&](int a, double) { shaken.col(a) += 0.1 * bond.length * random.normal_vector(); });
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
  const auto follows_here_and_beyond = [&](int k) {
    const std::vector<int>& bonds = clusters.at(cluster_of[k]);
    std::vector<int> independent;
    std::ranges::copy_if(bonds, std::back_inserter(independent),
                         [&](int other) { return !left_over[other]; });
    return follows_along_motion(sys, bonds_that_imply(sys, independent, k, x), k, x);
  };
  for (const int k : here)
    (follows[k] || follows_here_and_beyond(k) ? found.redundant : found.degenerate).push_back(k);
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
  const auto first_atom = [&](int k) {
    return full.bearers.empty() ? full.bonds[k].i : full.bearers[full.bonds[k].i].front().atom;
  };
  for (int k = 0, kept = 0; k < full.bond_count(); ++k) {
    full.for_each_bearer(full.bonds[k], [&](int a, double) { ties.push_back({first_atom(k), a}); });
    if (!dropped[k]) all[k] = lambda[kept++];
  }
  const std::vector<int> cluster_of = connected_components(full.atoms(), ties);
  std::map<int, std::vector<int>> overdetermined;  // the bonds of each overdetermined cluster
  for (const int k : left_out) overdetermined[cluster_of[first_atom(k)]];
  for (int k = 0; k < full.bond_count(); ++k)
    if (const auto at = overdetermined.find(cluster_of[first_atom(k)]); at != overdetermined.end())
      at->second.push_back(k);
  for (const auto& [cluster, bonds] : overdetermined) {
    std::map<int, int> row;  // the row of an atom in Jᵀ
    for (const int k : bonds)
      full.for_each_bearer(full.bonds[k],
                           [&](int a, double) { row.try_emplace(a, 3 * static_cast<int>(row.size())); });
    Eigen::MatrixXd J_t =
        Eigen::MatrixXd::Zero(3 * static_cast<int>(row.size()), static_cast<int>(bonds.size()));
    for (int c = 0; c < J_t.cols(); ++c) {
      const Vec3 r = full.along(full.bonds[bonds[c]], x);
      full.for_each_bearer(full.bonds[bonds[c]],
                           [&](int a, double weight) { J_t.block<3, 1>(row[a], c) += weight * r; });
    }
    all(bonds) = J_t.completeOrthogonalDecomposition().solve(J_t * all(bonds)).eval();
  }
  return all;
}

}  // namespace taut
