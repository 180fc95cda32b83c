#include "constraints/direct_solver.hpp"

#include <cmath>

namespace taut {

DirectSolver::DirectSolver(const System& sys) : DirectSolver(Couplings(sys)) {}

DirectSolver::DirectSolver(const Couplings& couplings)
    : reduced_inv_mass_(couplings.reduced_inv_mass),
      plan_(couplings, {}, Elimination::Order::kMinimumDegree),
      l_(plan_.entries()),
      u_(plan_.entries()),
      a_(plan_.size()),
      d_(plan_.size()),
      inv_d_(plan_.size()),
      work_(plan_.size()) {
  dependent_.reserve(plan_.size());
}

void DirectSolver::factor(const Vectors& r_new, const Vectors& r, double threshold) {
  const int n = plan_.size(), *order = plan_.order.data(), *start = plan_.column_start.data();
  const std::ptrdiff_t* row = plan_.row.data();
  const bool symmetric = &r_new == &r;
  for (int k = 0; k < n; ++k) {
    const Vec3 now = r.col(order[k]), next = r_new.col(order[k]);
    a_[k] = reduced_inv_mass_[order[k]] * next.dot(now);
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const int other = order[row[p]];
      const double s = plan_.signed_inv_mass[p];
      l_[p] = s * r_new.col(other).dot(now);
      u_[p] = symmetric ? l_[p] : s * next.dot(r.col(other));
    }
  }
  d_ = a_;
  dependent_.clear();
  const std::ptrdiff_t* update = plan_.update.data();
  for (int k = 0; k < n; ++k) {
    const double pivot = symmetric ? d_[k] : std::abs(d_[k]);
    const bool independent = a_[k] > 0 && pivot > threshold * a_[k];  // false for NaN
    inv_d_[k] = independent ? 1 / d_[k] : 0.0;
    if (!independent) dependent_.push_back(order[k]);
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const double above = u_[p];
      l_[p] *= inv_d_[k];
      u_[p] *= inv_d_[k];
      d_[row[p]] -= l_[p] * above;
      for (int q = p + 1; q < start[k + 1]; ++q, ++update) {
        l_[*update] -= u_[p] * l_[q];
        u_[*update] -= l_[p] * u_[q];
      }
    }
  }
}

void DirectSolver::solve(Eigen::VectorXd& b) {
  const int n = plan_.size(), *order = plan_.order.data(), *start = plan_.column_start.data();
  const std::ptrdiff_t* row = plan_.row.data();
  for (int k = 0; k < n; ++k) work_[k] = b[order[k]];
  for (int k = 0; k < n; ++k)
    for (int p = start[k]; p < start[k + 1]; ++p) work_[row[p]] -= l_[p] * work_[k];
  for (int k = n - 1; k >= 0; --k) {
    double z = work_[k] * inv_d_[k];
    for (int p = start[k]; p < start[k + 1]; ++p) z -= u_[p] * work_[row[p]];
    work_[k] = z;
  }
  for (int k = 0; k < n; ++k) b[order[k]] = work_[k];
}

}  // namespace taut
