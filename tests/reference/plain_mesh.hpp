#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut::tests {

struct MeshSums {
  double energy = 0;
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();  // −dE/dstrain
  Vectors f;
};

// The cardinal B-spline M_n(u) (eq. 4.1).
inline double spline(int n, double u) {
  if (n == 2) return std::max(0.0, 1 - std::abs(u - 1));
  return (u * spline(n - 1, u) + (n - u) * spline(n - 1, u - 1)) / (n - 1);
}

// Along an edge of K points: what an atom at u gives to each wave, Σ_k M_n(u − k) e^(−2πimk/K), and its
// slope.
struct WavesOfAtom {
  std::vector<std::complex<double>> value, slope;

  WavesOfAtom(int order, int K, double u) : value(K), slope(K) {
    for (int m = 0; m < K; ++m)
      for (int k = static_cast<int>(std::floor(u)) - order + 1; k <= u; ++k) {
        const auto turn = std::polar(1.0, -2 * std::numbers::pi * m * k / K);
        value[m] += spline(order, u - k) * turn;
        slope[m] += (spline(order - 1, u - k) - spline(order - 1, u - k - 1)) * turn;
      }
  }
};

// 1/|b(m)|² (eq. 4.4). Where it is zero, the mean of its neighbours, as OpenMM has it.
inline double spline_modulus(int order, int K, int m) {
  std::complex<double> sum = 0;
  for (int k = 0; k < order - 1; ++k)
    sum += spline(order, k + 1) * std::polar(1.0, 2 * std::numbers::pi * m * k / K);
  if (std::norm(sum) > 1e-7) return std::norm(sum);
  return (spline_modulus(order, K, m - 1) + spline_modulus(order, K, m + 1)) / 2;
}

// The sum of smooth particle mesh Ewald as it is written down (Essmann et al. 1995, doi:10.1063/1.470117, eq.
// 4.7): over all K₁K₂K₃ waves, m' = m up to K/2 and m − K beyond. With −K/2 in place of K/2, as OpenMM has
// it, it is the same: m'(k) is then −m'(−k).
inline MeshSums plain_mesh(const Eigen::VectorXd& charge, const PmeParameters& p, const Box& box,
                           const Vectors& x) {
  using std::numbers::pi;
  const int n = static_cast<int>(x.cols());
  MeshSums sum{.f = Vectors::Zero(3, n)};
  std::array<std::vector<WavesOfAtom>, 3> of;
  for (int d = 0; d < 3; ++d)
    for (int a = 0; a < n; ++a) {
      const double s = box.fractional(x.col(a))[d];
      of[d].emplace_back(p.order, p.grid[d], (s - std::floor(s)) * p.grid[d]);
    }
  const auto whole = [&](int d, int m) { return double(2 * m <= p.grid[d] ? m : m - p.grid[d]); };
  for (int i = 0; i < p.grid[0]; ++i)
    for (int j = 0; j < p.grid[1]; ++j)
      for (int k = 0; k < p.grid[2]; ++k) {
        const Vec3 m = box.reciprocal({whole(0, i), whole(1, j), whole(2, k)});
        const double m2 = m.squaredNorm(), decay = pi * pi * m2 / (p.alpha * p.alpha);
        if (m2 == 0) continue;
        const double moduli = spline_modulus(p.order, p.grid[0], i) * spline_modulus(p.order, p.grid[1], j) *
                              spline_modulus(p.order, p.grid[2], k);
        const double G = std::exp(-decay) / (pi * box.volume() * m2 * moduli);
        std::complex<double> F = 0;
        for (int a = 0; a < n; ++a)
          F += charge[a] * of[0][a].value[i] * of[1][a].value[j] * of[2][a].value[k];
        const double energy = 0.5 * G * std::norm(F);
        sum.energy += energy;
        sum.virial += energy * (Eigen::Matrix3d::Identity() - 2 * (1 + decay) / m2 * m * m.transpose());
        for (int a = 0; a < n; ++a) {
          const auto &u = of[0][a], &v = of[1][a], &w = of[2][a];
          const auto pull = [&](std::complex<double> slope) {
            return -charge[a] * G * std::real(std::conj(F) * slope);
          };
          sum.f.col(a) += box.reciprocal({p.grid[0] * pull(u.slope[i] * v.value[j] * w.value[k]),
                                          p.grid[1] * pull(u.value[i] * v.slope[j] * w.value[k]),
                                          p.grid[2] * pull(u.value[i] * v.value[j] * w.slope[k])});
        }
      }
  return sum;
}

}  // namespace taut::tests
