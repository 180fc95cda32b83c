#include "plain_ewald.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include "md/units.hpp"

namespace taut::tests {

PairSums plain_ewald(const Nonbonded& nb, const Box& box, const Vectors& x, double alpha) {
  using std::numbers::pi;
  const int n = static_cast<int>(x.cols());
  const double V = box.volume();
  PairSums sum(n);

  const double reach = 6.2 / alpha;
  Vec3 corner = Vec3::Zero();  // of the brick, as steps
  for (int k = 0; k < 4; ++k) {
    const Vec3 of(k % 2 ? 0.5 : -0.5, k / 2 ? 0.5 : -0.5, 0.5);
    corner = corner.cwiseMax(box.fractional(box.edge.cwiseProduct(of)).cwiseAbs());
  }
  Eigen::Array3i images;  // of the nearest
  for (int d = 0; d < 3; ++d)
    images[d] = static_cast<int>(reach * box.reciprocal(Vec3::Unit(d)).norm() + corner[d]);
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) {
      const Vec3 nearest = box.nearest_image(x.col(i) - x.col(j));
      const double kqq = kCoulomb * nb.charge[i] * nb.charge[j] * (i == j ? 0.5 : 1);
      for (int a = -images[0]; a <= images[0]; ++a)
        for (int b = -images[1]; b <= images[1]; ++b)
          for (int c = -images[2]; c <= images[2]; ++c) {
            const Vec3 d = nearest + box.lattice_vector(Vec3(a, b, c));
            const double r = d.norm(), u = alpha * r;
            if (r > reach || r == 0) continue;
            const double energy = kqq * std::erfc(u) / r;
            sum.add(i, j, d, {energy, energy + kqq * 2 * alpha / std::sqrt(pi) * std::exp(-u * u)});
          }
    }

  const Eigen::Array3i waves = (2 * alpha * box.vectors().colwise().norm().transpose().array())
                                   .ceil()
                                   .cast<int>();  // exp(−4π²) is 7e-18
  for (int a = -waves[0]; a <= waves[0]; ++a)
    for (int b = -waves[1]; b <= waves[1]; ++b)
      for (int c = -waves[2]; c <= waves[2]; ++c) {
        const Vec3 m = box.reciprocal(Vec3(a, b, c));
        const double m2 = m.squaredNorm(), decay = pi * pi * m2 / (alpha * alpha);
        if (m2 == 0 || decay > 40) continue;
        std::complex<double> S = 0;
        for (int i = 0; i < n; ++i) S += std::polar(nb.charge[i], 2 * pi * m.dot(x.col(i)));
        const double G = kCoulomb * std::exp(-decay) / (pi * V * m2);
        sum.energy += 0.5 * G * std::norm(S);
        sum.virial +=
            0.5 * G * std::norm(S) * (Eigen::Matrix3d::Identity() - 2 * (1 + decay) / m2 * m * m.transpose());
        for (int i = 0; i < n; ++i)
          sum.f.col(i) += 2 * pi * nb.charge[i] * G *
                          std::imag(std::conj(S) * std::polar(1.0, 2 * pi * m.dot(x.col(i)))) * m;
      }

  const double Q = nb.charge.sum(), background = -kCoulomb * pi * Q * Q / (2 * V * alpha * alpha);
  sum.energy += background - kCoulomb * alpha / std::sqrt(pi) * nb.charge.squaredNorm();
  sum.virial.diagonal().array() += background;
  for (const auto& e : nb.exceptions) {
    const Vec3 d = x.col(e.i) - x.col(e.j);
    if (d.isZero(0)) {
      sum.energy -= kCoulomb * nb.charge[e.i] * nb.charge[e.j] * 2 * alpha / std::sqrt(pi);
      continue;
    }
    const double energy = kCoulomb * (e.charge_product - nb.charge[e.i] * nb.charge[e.j]) / d.norm();
    sum.add(e.i, e.j, d, {energy, energy});
  }
  return sum;
}

}  // namespace taut::tests
