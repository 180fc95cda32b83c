#include "constraints/active_set.hpp"

#include <algorithm>

#include "constraints/bond_algebra.hpp"

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

}  // namespace

ActiveSet::ActiveSet(const System& sys)
    : solver_(sys, all_of(sys)),
      acting_(3, sys.all_bonds()),
      y_(3, sys.atoms()),
      target_(sys.all_bonds()),
      acts_(sys.all_bonds()) {}

void ActiveSet::solve_acting(const Vectors& r, const Eigen::VectorXd& b) {
  for (int k = 0; k < r.cols(); ++k) acting_.col(k) = acts_[k] == kActs ? Vec3(r.col(k)) : Vec3::Zero();
  solver_.factor(acting_);
  target_ = b;
  solver_.solve(target_);  // 0 where the vector is 0, and of a bond that depends on others
}

// Makes idle those guessed bonds whose λ has the wrong sign, or all of them if an ordinary bond depends on
// them.
bool ActiveSet::drop_guesses(const System& sys) {
  bool all = false, dropped = false;
  for (const int k : solver_.dependent_bonds()) all |= sys.side(k) == 0;
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k)
    if (acts_[k] == kActs && (all || sys.side(k) * target_[k] <= 0)) acts_[k] = kIdle, dropped = true;
  return dropped;
}

// Returns the idle bond whose sw is most negative, or −1.
int ActiveSet::most_wrong(const System& sys, const Vectors& r, const Eigen::VectorXd& b) {
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
void ActiveSet::go_as_far_as_allowed(const System& sys, Eigen::VectorXd& lambda) {
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

Failure ActiveSet::solve(const System& sys, const Vectors& r, const Eigen::VectorXd& b,
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

}  // namespace taut
