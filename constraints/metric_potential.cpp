#include "constraints/metric_potential.hpp"

#include <cmath>

namespace taut {

MetricPotential::MetricPotential(const System& sys)
    : sys_(sys),
      reduced_inv_mass_(Couplings(sys).reduced_inv_mass),
      plan_(Couplings(sys), {}, Elimination::Order::kMinimumDegree),
      r_(3, plan_.size()),
      g_(3, plan_.size()),
      l_(plan_.entries()),
      d_(plan_.size()),
      z_(plan_.entries()),
      z_diagonal_(plan_.size()) {
  std::ptrdiff_t next = 0;
  for (int k = 0; k < plan_.size(); ++k) {
    first_update_.push_back(next);
    const std::ptrdiff_t rows = plan_.column_start[k + 1] - plan_.column_start[k];
    next += rows * (rows - 1) / 2;
  }
}

void MetricPotential::factor() {
  const int n = plan_.size(), *order = plan_.order.data(), *start = plan_.column_start.data();
  for (int k = 0; k < n; ++k) {
    d_[k] = reduced_inv_mass_[order[k]] * r_.col(order[k]).squaredNorm();
    for (int p = start[k]; p < start[k + 1]; ++p)
      l_[p] = plan_.signed_inv_mass[p] * r_.col(order[k]).dot(r_.col(order[plan_.row[p]]));
  }
  const std::ptrdiff_t* update = plan_.update.data();
  for (int k = 0; k < n; ++k)
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const double above = l_[p];
      l_[p] /= d_[k];
      d_[plan_.row[p]] -= l_[p] * above;
      for (int q = p + 1; q < start[k + 1]; ++q, ++update) l_[*update] -= l_[p] * l_[q];
    }
}

// Z where L has entries. Rows p and q of a column are coupled, so that Z has their entry, too.
void MetricPotential::invert() {
  const int n = plan_.size(), *start = plan_.column_start.data();
  for (int k = n - 1; k >= 0; --k) {
    const int first = start[k], last = start[k + 1];
    for (int p = first; p < last; ++p) z_[p] = -z_diagonal_[plan_.row[p]] * l_[p];
    const std::ptrdiff_t* update = plan_.update.data() + first_update_[k];
    for (int p = first; p < last; ++p)
      for (int q = p + 1; q < last; ++q, ++update) {
        z_[p] -= z_[*update] * l_[q];
        z_[q] -= z_[*update] * l_[p];
      }
    z_diagonal_[k] = 1 / d_[k];
    for (int p = first; p < last; ++p) z_diagonal_[k] -= l_[p] * z_[p];
  }
}

double MetricPotential::add_forces(const Vectors& x, double kT, Vectors& f) {
  const int n = plan_.size(), *order = plan_.order.data(), *start = plan_.column_start.data();
  for (int k = 0; k < n; ++k) r_.col(k) = sys_.difference(sys_.bonds[k], x);
  factor();
  invert();
  double log_det = 0;
  for (int k = 0; k < n; ++k) {
    log_det += std::log(d_[k]);
    g_.col(order[k]) = z_diagonal_[k] * reduced_inv_mass_[order[k]] * r_.col(order[k]);
  }
  for (int k = 0; k < n; ++k)
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const int one = order[k], other = order[plan_.row[p]];
      const double z_s = z_[p] * plan_.signed_inv_mass[p];
      g_.col(one) += z_s * r_.col(other);
      g_.col(other) += z_s * r_.col(one);
    }
  for (int k = 0; k < n; ++k) {
    sys_.for_each_bearer(sys_.bonds[k], [&](int a, double c) { f.col(a) -= kT * c * g_.col(k); });
  }
  return 0.5 * kT * log_det;
}

}  // namespace taut
