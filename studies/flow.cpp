#include "studies/flow.hpp"

#include <cmath>
#include <numbers>

namespace taut {
namespace {

using Field = Flow::Field;

// f of the neighbour (i + di, j + dj) at (i, j).
Field at(const Field& f, int di, int dj) {
  const auto n = f.rows();
  Field shifted(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) shifted(i, j) = f((i + di + n) % n, (j + dj + n) % n);
  return shifted;
}

// Where u stands: (i, j + ½)Δx; v: (i + ½, j)Δx; the cell's middle: both halves.
Field sampled(int n, double i0, double j0, auto&& f) {
  const double dx = 2 * std::numbers::pi / n;
  Field values(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) values(i, j) = f((i + i0) * dx, (j + j0) * dx);
  return values;
}
Field vortex_u(int n) {
  return sampled(n, 0, 0.5, [](double x, double y) { return std::cos(x) * std::sin(y); });
}
Field vortex_v(int n) {
  return sampled(n, 0.5, 0, [](double x, double y) { return -std::sin(x) * std::cos(y); });
}

}  // namespace

Flow::Flow(const Options& options, double push)
    : options_(options),
      dx_(2 * std::numbers::pi / options.cells),
      u_(vortex_u(options.cells)),
      v_(vortex_v(options.cells)),
      sigma_(Field::Zero(options.cells, options.cells)),
      lambda_(sigma_),
      correction_(sigma_) {
  const auto source = [](double x, double y) {
    return std::cos(2 * x) * std::cos(y) + 0.3 * std::sin(3 * y);
  };
  add_gradient(push, sampled(options.cells, 0.5, 0.5, source), u_, v_);
}

Field Flow::divergence(const Field& u, const Field& v) const {
  return (at(u, 1, 0) - u + at(v, 0, 1) - v) / dx_;
}

void Flow::add_gradient(double by, const Field& lambda, Field& u, Field& v) const {
  u += by * (at(lambda, -1, 0) - lambda) / dx_;
  v += by * (at(lambda, 0, -1) - lambda) / dx_;
}

// F = −∇·(u u) + ν∇²u, both centred: momentum through the sides of the boxes about each u and each v.
Flow::Velocity Flow::force(const Field& u, const Field& v) const {
  const Field u_mid = 0.5 * (u + at(u, 1, 0)), v_mid = 0.5 * (v + at(v, 0, 1));  // in cells
  const Field corner = 0.25 * (u + at(u, 0, -1)) * (v + at(v, -1, 0));           // u v at cells' lower left
  const auto laplacian = [&](const Field& f) -> Field {
    return (at(f, 1, 0) + at(f, -1, 0) + at(f, 0, 1) + at(f, 0, -1) - 4 * f) / (dx_ * dx_);
  };
  const Field uu = u_mid.square(), vv = v_mid.square();
  return {options_.viscosity * laplacian(u) - (uu - at(uu, -1, 0) + at(corner, 0, 1) - corner) / dx_,
          options_.viscosity * laplacian(v) - (vv - at(vv, 0, -1) + at(corner, 1, 0) - corner) / dx_};
}

// Conjugate gradients. D Dᵀ takes a constant to 0, and b has none.
void Flow::solve(const Field& b, Field& lambda) {
  const auto times = [&](const Field& x) {
    Field u = Field::Zero(x.rows(), x.cols()), v = u;
    add_gradient(1, x, u, v);
    return divergence(u, v);
  };
  Field r = b - times(lambda), p = r;
  double rr = r.square().sum();
  constexpr double kRounding = 1e-13;  // of divergences of velocities of 1
  const double enough = std::max(std::pow(options_.tolerance, 2) * b.square().sum(),
                                 std::pow(kRounding, 2) * static_cast<double>(b.size()));
  for (int n = 0; n < 10 * options_.cells && rr > enough; ++n, ++iterations_) {
    const Field Ap = times(p);
    const double along = rr / (p * Ap).sum();
    lambda += along * p;
    r -= along * Ap;
    const double left = r.square().sum();
    p = r + left / rr * p;
    rr = left;
  }
}

void Flow::step() {
  const double h = options_.h;
  const auto [ah, bh] =
      options_.keeps == Keeps::kFeedsBack ? std::pair(options_.ah, options_.bh) : std::pair(0., 0.);
  // At the step's middle, from the velocities half a step before it and a step earlier (Adams and Bashforth).
  const Velocity now = force(u_, v_);
  if (first_) before_ = now;
  first_ = false;
  const Field fu = 1.5 * now.u - 0.5 * before_.u, fv = 1.5 * now.v - 0.5 * before_.v;
  before_ = now;

  const Field rate = divergence(u_ + 0.5 * h * fu, v_ + 0.5 * h * fv);
  solve(-(divergence(fu, fv) + 2 * ah / h * rate + bh * bh / (h * h) * sigma_) / (1 + ah), lambda_);
  u_ += h * fu;
  v_ += h * fv;
  add_gradient(h, lambda_, u_, v_);
  if (options_.keeps == Keeps::kProjects) {
    correction_.setZero();
    solve(-divergence(), correction_);
    add_gradient(1, correction_, u_, v_);
  }
  sigma_ += h * divergence();
  t_ += h;
}

double Flow::error() const {
  const double decay = std::exp(-2 * options_.viscosity * t_);
  return std::sqrt(
      ((u_ - decay * vortex_u(options_.cells)).square() + (v_ - decay * vortex_v(options_.cells)).square())
          .mean() /
      2);
}

}  // namespace taut
