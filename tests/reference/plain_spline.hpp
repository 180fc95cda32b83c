#pragma once

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "forcefield/spline.hpp"

// The natural cubic spline of a table, written down plainly by its second derivatives M at the points (Press et al.,
// Numerical Recipes, section 3.3):
//     M_0 = M_{n−1} = 0,   M_{i−1} + 4M_i + M_{i+1} = 6(y_{i+1} − 2y_i + y_{i−1})/h²,
//     y(x) = A y_i + B y_{i+1} + ((A³ − A) M_i + (B³ − B) M_{i+1}) h²/6,   B = (x − x_i)/h,  A = 1 − B.

namespace taut::tests {

class PlainSpline {
 public:
  explicit PlainSpline(const Spline& table)
      : first_(table.first()),
        y_(Eigen::VectorXd::Map(table.values().data(), static_cast<Eigen::Index>(table.values().size()))),
        h_((table.last() - table.first()) / static_cast<double>(y_.size() - 1)) {
    const Eigen::Index n = y_.size();
    Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      left(i, i - 1) = left(i, i + 1) = 1;
      left(i, i) = 4;
      right[i] = 6 * (y_[i + 1] - 2 * y_[i] + y_[i - 1]) / (h_ * h_);
    }
    M_ = left.partialPivLu().solve(right);
  }

  double value(double x) const {
    const auto [i, A, B] = interval(x);
    return A * y_[i] + B * y_[i + 1] + ((A * A * A - A) * M_[i] + (B * B * B - B) * M_[i + 1]) * h_ * h_ / 6;
  }
  double slope(double x) const {
    const auto [i, A, B] = interval(x);
    return (y_[i + 1] - y_[i]) / h_ + ((1 - 3 * A * A) * M_[i] + (3 * B * B - 1) * M_[i + 1]) * h_ / 6;
  }

 private:
  struct Interval {
    Eigen::Index i;
    double A, B;
  };
  Interval interval(double x) const {
    const double at = (x - first_) / h_;
    const auto i = std::min(static_cast<Eigen::Index>(at), y_.size() - 2);
    return {i, static_cast<double>(i) + 1 - at, at - static_cast<double>(i)};
  }

  double first_;
  Eigen::VectorXd y_, M_;
  double h_;
};

}  // namespace taut::tests
