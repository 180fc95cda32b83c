#include "constraints/active_set.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "constraints/bond_algebra.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {
namespace {

constexpr char kIdle = 0, kActs = 1;
constexpr char kPassedOver = 2;      // idle until another one joins
constexpr double kRounding = 1e-10;  // of the terms of w

std::vector<RigidBond> all_of(const System& sys) {
  std::vector<RigidBond> bonds;
  for (int k = 0; k < sys.all_bonds(); ++k) bonds.push_back(sys.bond(k));
  return bonds;
}

// All bonds by clusters. Anchors couple none.
std::vector<std::vector<int>> clusters_of(const System& sys) {
  std::vector<IndexPair> coupled;
  const std::vector<RigidBond> bonds = all_of(sys);
  for (const auto& [i, j, d] : bonds)
    if (sys.inv_mass[i] != 0 && sys.inv_mass[j] != 0) coupled.push_back({i, j});
  const std::vector<int> of_atom = connected_components(sys.atoms(), coupled);
  const auto cluster_of = [&](int k) {
    return of_atom[sys.inv_mass[bonds[k].i] != 0 ? bonds[k].i : bonds[k].j];
  };

  constexpr int kNoneOneSided = -1;
  std::vector<char> has_one_sided(sys.atoms(), false);
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) has_one_sided[cluster_of(k)] = true;
  std::map<int, std::vector<int>> clusters;
  for (int k = 0; k < sys.all_bonds(); ++k)
    clusters[has_one_sided[cluster_of(k)] ? cluster_of(k) : kNoneOneSided].push_back(k);
  std::vector<std::vector<int>> all;
  for (auto& [cluster, its_bonds] : clusters) all.push_back(std::move(its_bonds));
  return all;
}

// These bonds, in ascending order, and the atoms that they join.
System part_of(const System& sys, const std::vector<int>& bonds) {
  System part;
  std::map<int, int> place;  // of an atom in the part
  for (const int k : bonds) {
    RigidBond bond = sys.bond(k);
    for (int* atom : {&bond.i, &bond.j})
      *atom = place.try_emplace(*atom, static_cast<int>(place.size())).first->second;
    if (sys.side(k) == 0)
      part.bonds.push_back(bond);
    else
      part.one_sided.push_back({bond, static_cast<Side>(sys.side(k))});
  }
  part.mass.resize(std::ssize(place));
  part.inv_mass.resize(std::ssize(place));
  for (const auto& [atom, at] : place) part.mass[at] = sys.mass[atom], part.inv_mass[at] = sys.inv_mass[atom];
  return part;
}

}  // namespace

ActiveSetOfCluster::ActiveSetOfCluster(const System& sys)
    : solver_(sys, all_of(sys)),
      acting_(3, sys.all_bonds()),
      y_(3, sys.atoms()),
      target_(sys.all_bonds()),
      acts_(sys.all_bonds()) {}

void ActiveSetOfCluster::solve_acting(const Vectors& r, const Eigen::VectorXd& b) {
  for (int k = 0; k < r.cols(); ++k) acting_.col(k) = acts_[k] == kActs ? Vec3(r.col(k)) : Vec3::Zero();
  solver_.factor(acting_);
  target_ = b;
  solver_.solve(target_);  // 0 where the vector is 0, and of a bond that depends on others
}

// Makes idle those guessed bonds whose λ has the wrong sign, or all of them if an ordinary bond depends on
// them.
bool ActiveSetOfCluster::drop_guesses(const System& sys) {
  bool all = false, dropped = false;
  for (const int k : solver_.dependent_bonds()) all |= sys.side(k) == 0;
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k)
    if (acts_[k] == kActs && (all || sys.side(k) * target_[k] <= 0)) acts_[k] = kIdle, dropped = true;
  return dropped;
}

// Returns the idle bond whose sw is most negative, or −1.
int ActiveSetOfCluster::most_wrong(const System& sys, const Vectors& r, const Eigen::VectorXd& b) {
  y_.setZero();
  add_constraint_acceleration(sys, acting_, target_, y_);
  int worst = -1;
  double most = 0;
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) {
    if (acts_[k] != kIdle) continue;
    const auto& [i, j, d] = sys.bond(k);
    const double w = r.col(k).dot(y_.col(j) - y_.col(i)) - b[k];
    const double terms = std::abs(b[k]) + r.col(k).norm() * (y_.col(i).norm() + y_.col(j).norm());
    if (-sys.side(k) * w > std::max(most, kRounding * terms)) most = -sys.side(k) * w, worst = k;
  }
  return worst;
}

// λ ← λ + α (target − λ) with the largest α ≤ 1 that keeps every sλ ≥ 0; a bond whose λ reaches 0 becomes
// idle.
void ActiveSetOfCluster::go_as_far_as_allowed(const System& sys, Eigen::VectorXd& lambda) {
  double alpha = 1;
  int first = -1;
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) {
    if (acts_[k] != kActs || sys.side(k) * target_[k] > 0) continue;
    const double share = lambda[k] == target_[k] ? 0 : lambda[k] / (lambda[k] - target_[k]);
    if (first < 0 || share < alpha) alpha = share, first = k;
  }
  lambda += alpha * (target_ - lambda);
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) {
    if (acts_[k] == kActs && (k == first || sys.side(k) * lambda[k] <= 0)) acts_[k] = kIdle;
    if (acts_[k] != kActs) lambda[k] = 0;
  }
}

Failure ActiveSetOfCluster::solve(const System& sys, const Vectors& r, const Eigen::VectorXd& b,
                                  Eigen::VectorXd& lambda) {
  for (int k = 0; k < sys.all_bonds(); ++k)
    acts_[k] = sys.side(k) == 0 || sys.side(k) * lambda[k] > 0 ? kActs : kIdle;
  do solve_acting(r, b);
  while (drop_guesses(sys));
  for (const int k : solver_.dependent_bonds())
    if (sys.side(k) == 0) return blamed_ = k, Failure::kSingular;
  lambda = target_;
  const int most_changes = 20 + 10 * sys.all_bonds();
  int changes = 0;
  while ((blamed_ = most_wrong(sys, r, b)) >= 0) {
    if (++changes > most_changes) return Failure::kNoConvergence;
    acts_[blamed_] = kActs;
    solve_acting(r, b);
    if (!(sys.side(blamed_) * target_[blamed_] > 0)) {  // to rounding it depends on those that act
      acts_[blamed_] = kPassedOver;
      solve_acting(r, b);
      continue;
    }
    std::ranges::replace(acts_, kPassedOver, kIdle);
    const auto on_wrong_side = [&] {
      for (int k = sys.bond_count(); k < sys.all_bonds(); ++k)
        if (acts_[k] == kActs && sys.side(k) * target_[k] <= 0) return true;
      return false;
    };
    while (on_wrong_side()) {
      if (++changes > most_changes) return Failure::kNoConvergence;
      go_as_far_as_allowed(sys, lambda);
      solve_acting(r, b);
    }
    lambda = target_;
  }
  return Failure::kNone;
}

ActiveSet::Cluster::Cluster(const System& sys, std::vector<int> its_bonds)
    : bonds(std::move(its_bonds)),
      system(part_of(sys, bonds)),
      set(system),
      r(3, system.all_bonds()),
      b(system.all_bonds()),
      lambda(system.all_bonds()) {}

ActiveSet::ActiveSet(const System& sys) {
  for (std::vector<int>& bonds : clusters_of(sys)) clusters_.emplace_back(sys, std::move(bonds));
}

Failure ActiveSet::solve(const System&, const Vectors& r, const Eigen::VectorXd& b, Eigen::VectorXd& lambda) {
  for (Cluster& cluster : clusters_) {
    for (std::size_t k = 0; k < cluster.bonds.size(); ++k) {
      const int of_all = cluster.bonds[k];
      cluster.r.col(k) = r.col(of_all);
      cluster.b[k] = b[of_all];
      cluster.lambda[k] = lambda[of_all];
    }
    const Failure failure = cluster.set.solve(cluster.system, cluster.r, cluster.b, cluster.lambda);
    if (failure != Failure::kNone) return blamed_ = cluster.bonds[cluster.set.blamed()], failure;
    for (std::size_t k = 0; k < cluster.bonds.size(); ++k) lambda[cluster.bonds[k]] = cluster.lambda[k];
  }
  return Failure::kNone;
}

}  // namespace taut
