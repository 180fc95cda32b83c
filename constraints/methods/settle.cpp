#include "constraints/methods/settle.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "constraints/bond_graph.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/methods/settle.cpp"
#include <hwy/foreach_target.h>

#include "base/inverses-inl.hpp"
#include "constraints/batch/velocities-inl.hpp"

#ifndef TAUT_SETTLE_STEP
#define TAUT_SETTLE_STEP
namespace taut {
struct SettleStep {
  double h;
  double *x, *v;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// 1/√x
template <int K>
HWY_INLINE void inverse_roots(const V (&x)[K], V (&y)[K]) {
  for (int k = 0; k < K; ++k) y[k] = guess_inverse_sqrt(D(), x[k]);
  inverse_sqrt(D(), x, y);
}

// Names follow the paper: 0 is before the step, 1 after the drift, 2 after the rotations φ and ψ, 3 after θ.
// The axes XYZ have their origin at the drifted centre of mass, Z along the normal of the old triangle, and
// the drifted apex in the plane YZ. Unlike there, all is written in sums and differences of the hydrogens'
// positions, which takes few square roots that depend on each other. The vector n = b0 × c0 lies along Z,
// u = n × (b1 + c1 − 2a1) along X, and w = n × u along Y. In the plane XY the old base e = b0 − c0 is (Ex, Ey),
// and b0 + c0, perpendicular to it, is (−Ey, Ex) h/rc with the height h = ra + rb. With p = n·a1/ra and
// q = n·(b1 − c1)/2rc,
//     sin φ = p/|n|,  cos φ = √P/|n|,  sin ψ = q/√P,  cos ψ = √Q/√P,  P = |n|² − p²,  Q = P − q²,
//     B = rb cos φ,  C = rc cos ψ,  T = rc sin ψ sin φ,  G = C + B h/rc:
//     x2, y2 of b and c: ∓C, −B ∓ T;  α = −G Ex − T Ey,  β = G Ey − T Ex,
//     γ = ½ Z·((b0 + c0) × (b1 + c1) + e × (b1 − c1)),  ρ = √(α² + β² − γ²),
//     (sin θ, cos θ) = (α γ − β ρ, β γ + α ρ)/(α² + β²).
// No atom moves along Z. Returns the lanes in which a solution exists.
HWY_INLINE M settle_triangles(const Settle::Batch& batch, const Sides& now, const Sides& old, Nine& shift) {
  const double inv_a = batch.lanes.inv_mass[0], inv_h = batch.lanes.inv_mass[1];
  const double share = inv_a / (2 * inv_a + inv_h), slope = (batch.ra + batch.rb) / batch.rc;
  const V3 sum = now.ab + now.ac, difference = now.ab - now.ac, e = old.ab - old.ac;
  const V3 n = cross(old.ab, old.ac), u = cross(n, sum), w = cross(n, u);
  const V nn = dot(n, n), uu = dot(u, u);
  const V p = -share / batch.ra * dot(n, sum), q = 0.5 / batch.rc * dot(n, difference);
  const V P = nn - p * p, Q = P - q * q;
  const V squares[] = {nn, uu, P, Q};
  V inverse[4];
  inverse_roots(squares, inverse);
  const auto& [by_n, by_u, by_P, by_Q] = inverse;
  const V by_w = by_n * by_u;

  const V sin_phi = p * by_n, cos_phi = P * by_P * by_n;
  const V sin_psi = q * by_P, cos_psi = Q * by_Q * by_P;
  const V B = batch.rb * cos_phi, C = batch.rc * cos_psi, T = batch.rc * sin_psi * sin_phi;
  const V G = slope * B + C;

  const V Ex = by_u * dot(u, e), Ey = by_w * dot(w, e);
  const V Dx = by_u * dot(u, difference), Dy = by_w * dot(w, difference);
  const V Sy = (1 - 2 * share) * (uu * by_w);  // −(b1 + c1)·Y
  const V minus_alpha = T * Ey + G * Ex, beta = hn::MulSub(G, Ey, T * Ex);
  const V gamma = 0.5 * (Ey * (slope * Sy - Dx) + Ex * Dy);
  const V norm = minus_alpha * minus_alpha + beta * beta;
  const V rho2[] = {norm - gamma * gamma};
  V by_rho[1];
  inverse_roots(rho2, by_rho);
  const V rho = rho2[0] * by_rho[0], minus_by_norm = -1 / norm;
  const V sine = minus_by_norm * (beta * rho + minus_alpha * gamma);
  const V cosine = minus_by_norm * hn::MulSub(minus_alpha, rho, beta * gamma);

  // Half of the displacements of the sum and of the difference.
  const V3 middle = by_w * hn::NegMulAdd(B, cosine, 0.5 * Sy) * w + by_u * (B * sine) * u;
  const V3 apart = -by_w * (hn::MulAdd(T, cosine, 0.5 * Dy) + C * sine) * w +
                   by_u * (T * sine - hn::MulAdd(C, cosine, 0.5 * Dx)) * u;
  const V3 a = -2 * inv_a / inv_h * middle, b = middle + apart, c = middle - apart;
  shift = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
  const V all = sine + cosine + by_u;
  return all - all == 0;
}

HWY_INLINE void settle_part(const Settle::Batch& batch, const SettleStep& step, const Part& part,
                            SolveStats& stats) {
  HWY_ALIGN double copies[2][9 * kWidth];
  const Nines nines(part);
  double *x = nines.open(step.x, copies[0]), *v = nines.open(step.v, copies[1]);
  const Sides now = sides(rows_of(load_nine(x))), rate = sides(rows_of(load_nine(v)));
  Nine rows;
  const M found = settle_triangles(batch, now, now - step.h * rate, rows);
  if (!hn::AllTrue(D(), found)) {
    const int lane = part.first_lane + static_cast<int>(hn::FindFirstTrue(D(), hn::Not(found)));
    stats.beside({.worst_bond = batch.lanes.bond(part.group, 0, lane), .failure = Failure::kShapeLost});
    return;
  }
  const double by_h = 1 / step.h;
  const Nine shifts = numbers_of(rows);
  for (int k = 0; k < 9; ++k) {
    double *x_k = x + k * kWidth, *v_k = v + k * kWidth;
    store_any(load_any(x_k) + shifts.n[k], x_k);
    store_any(load_any(v_k) + by_h * shifts.n[k], v_k);
  }
  nines.close(x, step.x);
  nines.close(v, step.v);
}

template <class Shape>
struct SettleVelocityKernel : VelocityKernel<Shape> {
  HWY_INLINE SettleVelocityKernel(const Shape its_shape, Settle::Batch& batch, const VelocityStep& its_step,
                                  const Part& its_part, Scratch& scratch)
      : VelocityKernel<Shape>(its_shape, batch.lambda, its_step, its_part, equations(its_shape, scratch),
                              scratch) {}
};

SolveStats settle_positions(Settle::Batch& batch, const SettleStep& step, int begin, int end,
                            const Scratch&) {
  SolveStats stats{.iterations = 1};
  for (int g = begin; g < end; ++g)
    for (int l = 0; l < batch.lanes.filled(g); l += kWidth)
      settle_part(batch, step, Part{batch.lanes, g, l}, stats);
  return stats;
}

SolveStats settle_velocities(Settle::Batch& batch, const VelocityStep& step, int begin, int end,
                             const Scratch& scratch) {
  return solve_triangles<SettleVelocityKernel>(
      batch, step, {begin, end, scratch}, [&](const Part& part, SolveStats& stats) HWY_ATTR {
        return solve_velocities(batch.lanes, batch.lambda, step, part, stats);
      });
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(settle_positions);
HWY_EXPORT(settle_velocities);

std::vector<Settle::Water> Settle::waters_in(const System& sys) {
  const auto bonds_at = bonds_at_atoms(sys);
  const auto other_end = [&](int k, int a) { return sys.bonds[k].i == a ? sys.bonds[k].j : sys.bonds[k].i; };
  const auto bond_between = [&](int a, int b) {
    for (int k : bonds_at[a])
      if (std::minmax(sys.bonds[k].i, sys.bonds[k].j) == std::minmax(a, b)) return k;
    return -1;
  };
  const auto alike = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(a); };

  std::vector<Water> waters;
  std::vector<char> held(sys.bond_count(), false);
  for (int a = 0; a < sys.atoms(); ++a) {
    if (bonds_at[a].size() != 2) continue;
    const int p = bonds_at[a][0], q = bonds_at[a][1];
    const int left = other_end(p, a), right = other_end(q, a), base = bond_between(left, right);
    if (base < 0 || held[p] || bonds_at[left].size() != 2 || bonds_at[right].size() != 2) continue;
    if (!alike(sys.bonds[p].length, sys.bonds[q].length) || !alike(sys.mass[left], sys.mass[right])) continue;
    if (sys.mass[a] == 0 || sys.mass[left] == 0 || sys.reach_of(a) == Reach::kCluster) continue;
    const double side = sys.bonds[p].length, half = 0.5 * sys.bonds[base].length;
    if (!(side > half)) continue;
    const double height = std::sqrt(side * side - half * half);
    const double ra = 2 * sys.mass[left] * height / (sys.mass[a] + 2 * sys.mass[left]);
    waters.push_back({a, left, right, {p, q, base}, ra, height - ra, half});
    held[p] = held[q] = held[base] = true;
  }
  return waters;
}

Settle::Parts Settle::parts_of(const System& sys) {
  Parts parts;
  std::vector<char> held(sys.bond_count(), false);
  for (const Water& water : waters_in(sys))
    for (const int k : water.bonds) held[k] = true;
  for (int k = 0; k < sys.bond_count(); ++k) (held[k] ? parts.of_waters : parts.rest).push_back(k);
  return parts;
}

std::vector<Settle::Water> Settle::find_waters(const System& sys) {
  if (const Parts parts = parts_of(sys); !parts.rest.empty()) {
    const int k = parts.rest.front();
    throw InputError(
        fmt::format("method settle: bond {} ({}-{}) is not part of a three-site water (a triangle by "
                    "itself, two sides and the masses at their ends equal, none anchored, closed through "
                    "the box or bearing a bond of a virtual site); take newton or "
                    "rattle, or settle with method.solute = \"newton\"",
                    k, sys.bonds[k].i, sys.bonds[k].j));
  }
  return waters_in(sys);
}

Settle::Settle(const System& sys, const Options&, double)
    : batches_(BondClusters{}), lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  std::map<std::array<double, 5>, std::pair<Settle::Water, ClusterBatch>> kinds;
  for (const Settle::Water& w : Settle::find_waters(sys)) {
    const double m_a = sys.inv_mass[w.apex], m_h = sys.inv_mass[w.left];
    auto& [water, batch] = kinds[{m_a, m_h, w.ra, w.rb, w.rc}];
    if (batch.count++ == 0) {
      water = w;
      const double side = sys.bonds[w.bonds[0]].length, base = sys.bonds[w.bonds[2]].length;
      batch.shape = {{{0, 1, side}, {0, 2, side}, {1, 2, base}}, {m_a, m_h, m_h}};
    }
    batch.atoms.insert(batch.atoms.end(), {w.apex, w.left, w.right});
    batch.bonds.insert(batch.bonds.end(), w.bonds.begin(), w.bonds.end());
  }
  for (const auto& [key, kind] : kinds) {
    const auto& [water, batch] = kind;
    batches_.add(batch, water);
  }
}

SolveStats Settle::project_positions(const System&, double h, State& s) {
  const SettleStep step{h, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(settle_positions), step);
}

SolveStats Settle::project_velocities(const System&, double h, State& s) {
  const VelocityStep step{h, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(settle_velocities), step);
}

const Eigen::VectorXd& Settle::lambda() const {
  batches_.write_lambda(lambda_);
  return lambda_;
}

std::string Settle::setting() const {
  int waters = 0;
  for (const Batch& batch : batches_) waters += batch.lanes.clusters;
  return fmt::format("{} waters", waters);
}

}  // namespace taut
#endif
