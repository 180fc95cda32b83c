#include "forcefield/bonded/cmap.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcefield/bonded/dihedral.hpp"

namespace taut {
namespace {

// The matrix S such that S y are the slopes, per point, of the periodic cubic spline through the n values y:
//     s_{i−1} + 4 s_i + s_{i+1} = 3(y_{i+1} − y_{i−1}).
Eigen::MatrixXd spline_slopes(int n) {
  Eigen::MatrixXd left = 4 * Eigen::MatrixXd::Identity(n, n), right = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n, last = (i + n - 1) % n;
    left(i, next) += 1;
    left(i, last) += 1;
    right(i, next) += 3;
    right(i, last) -= 3;
  }
  return left.partialPivLu().solve(right);
}

Dihedral dihedral(const std::array<int, 4>& a, const Vectors& x) {
  return {x.col(a[0]), x.col(a[1]), x.col(a[2]), x.col(a[3])};
}

void subtract(const std::array<int, 4>& a, const Dihedral& d, double slope, Vectors& f) {
  f.col(a[0]) -= slope * d.grad_i;
  f.col(a[1]) -= slope * d.grad_j;
  f.col(a[2]) -= slope * d.grad_k;
  f.col(a[3]) -= slope * d.grad_l;
}

// The cell that an angle lies in, and the fraction of the cell that lies below it. NaN gives a fraction of
// NaN.
struct MapPosition {
  int cell;
  double within;

  MapPosition(double angle, int n) {
    const double turns = angle / (2 * std::numbers::pi), at = (turns - std::floor(turns)) * n;
    cell = at < n ? static_cast<int>(at) : n - 1;
    within = at - cell;
  }
};

}  // namespace

// The cubic from y₀ to y₁ with slopes s₀ and s₁ has the coefficients H (y₀, y₁, s₀, s₁)ᵀ; H is `hermite`.
CmapSurface::CmapSurface(const Eigen::MatrixXd& points) : n_(static_cast<int>(points.rows())) {
  const Eigen::MatrixXd slopes = spline_slopes(n_);
  const Eigen::MatrixXd of_t = slopes * points, of_u = points * slopes.transpose(), of_tu = slopes * of_u;
  Eigen::Matrix4d hermite;
  hermite << 1, 0, 0, 0,  //
      0, 0, 1, 0,         //
      -3, 3, -2, -1,      //
      2, -2, 1, 1;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) {
      const std::array rows{i, (i + 1) % n_}, columns{j, (j + 1) % n_};
      Eigen::Matrix4d corners;
      corners << points(rows, columns), of_u(rows, columns), of_t(rows, columns), of_tu(rows, columns);
      cells_.push_back(hermite * corners * hermite.transpose());
    }
}

CmapSurface::Value CmapSurface::at(double phi, double psi) const {
  const MapPosition a(phi, n_), b(psi, n_);
  const double t = a.within, u = b.within, per_radian = n_ / (2 * std::numbers::pi);
  const Eigen::RowVector4d power(1, t, t * t, t * t * t), slope(0, 1, 2 * t, 3 * t * t);
  const Eigen::Vector4d of_u = cells_[a.cell * n_ + b.cell] * Eigen::Vector4d(1, u, u * u, u * u * u);
  const Eigen::Vector4d slope_u = cells_[a.cell * n_ + b.cell] * Eigen::Vector4d(0, 1, 2 * u, 3 * u * u);
  return {power * of_u, slope.dot(of_u) * per_radian, power.dot(slope_u) * per_radian};
}

std::vector<CmapPair> cmap_pairs(const std::vector<Eigen::MatrixXd>& maps,
                                 const std::vector<CmapTorsion>& torsions) {
  std::vector<std::shared_ptr<const CmapSurface>> surfaces;
  for (const auto& map : maps) surfaces.push_back(std::make_shared<const CmapSurface>(map));
  std::vector<CmapPair> pairs;
  for (const auto& [phi, psi, map] : torsions) pairs.push_back({phi, psi, surfaces[map]});
  return pairs;
}

double add_term_forces(std::span<const CmapPair> pairs, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const CmapPair& pair : pairs) {
    const Dihedral phi = dihedral(pair.phi, x), psi = dihedral(pair.psi, x);
    const auto [value, of_phi, of_psi] = pair.surface->at(phi.phi, psi.phi);
    energy += value;
    subtract(pair.phi, phi, of_phi, f);
    subtract(pair.psi, psi, of_psi, f);
  }
  return energy;
}

}  // namespace taut
