#include "constraints/batch/batched_settle.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_settle.cpp"
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

// settle.cpp has the derivation and the names: 0 is before the step, 1 after the drift, 2 after φ and ψ, 3
// after θ. Here it is written in sums and differences of the hydrogens' positions, which takes few square
// roots that depend on each other. The vector n = b0 × c0 lies along Z, u = n × (b1 + c1 − 2a1) along X, and
// w = n × u along Y. In the plane XY the old base e = b0 − c0 is (Ex, Ey), and b0 + c0, perpendicular to it,
// is (−Ey, Ex) h/rc with the height h = ra + rb. With p = n·a1/ra and q = n·(b1 − c1)/2rc,
//     sin φ = p/|n|,  cos φ = √P/|n|,  sin ψ = q/√P,  cos ψ = √Q/√P,  P = |n|² − p²,  Q = P − q²,
//     B = rb cos φ,  C = rc cos ψ,  T = rc sin ψ sin φ,  G = C + B h/rc:
//     x2, y2 of b and c: ∓C, −B ∓ T;  α = −G Ex − T Ey,  β = G Ey − T Ex,
//     γ = ½ Z·((b0 + c0) × (b1 + c1) + e × (b1 − c1)),  ρ = √(α² + β² − γ²),
//     (sin θ, cos θ) = (α γ − β ρ, β γ + α ρ)/(α² + β²).
// No atom moves along Z. Returns the lanes in which a solution exists.
HWY_INLINE M settle_triangles(const SettleBatch& batch, const Sides& now, const Sides& old, Nine& shift) {
  const double inv_a = batch.lanes.inv_mass[0], inv_h = batch.lanes.inv_mass[1];
  const double share = inv_a / (2 * inv_a + inv_h), slope = (batch.ra + batch.rb) / batch.rc;
  const V half = broadcast(0.5);
  const V3 sum = now.ab + now.ac, difference = now.ab - now.ac, e = old.ab - old.ac;
  const V3 n = cross(old.ab, old.ac), u = cross(n, sum), w = cross(n, u);
  const V nn = dot(n, n), uu = dot(u, u);
  const V p = hn::Mul(broadcast(-share / batch.ra), dot(n, sum)),
          q = hn::Mul(broadcast(0.5 / batch.rc), dot(n, difference));
  const V P = hn::NegMulAdd(p, p, nn), Q = hn::NegMulAdd(q, q, P);
  const V squares[] = {nn, uu, P, Q};
  V inverse[4];
  inverse_roots(squares, inverse);
  const auto& [by_n, by_u, by_P, by_Q] = inverse;
  const V by_w = hn::Mul(by_n, by_u);

  const V sin_phi = hn::Mul(p, by_n), cos_phi = hn::Mul(hn::Mul(P, by_P), by_n);
  const V sin_psi = hn::Mul(q, by_P), cos_psi = hn::Mul(hn::Mul(Q, by_Q), by_P);
  const V B = hn::Mul(broadcast(batch.rb), cos_phi), C = hn::Mul(broadcast(batch.rc), cos_psi);
  const V T = hn::Mul(hn::Mul(broadcast(batch.rc), sin_psi), sin_phi);
  const V G = hn::MulAdd(broadcast(slope), B, C);

  const V Ex = hn::Mul(by_u, dot(u, e)), Ey = hn::Mul(by_w, dot(w, e));
  const V Dx = hn::Mul(by_u, dot(u, difference)), Dy = hn::Mul(by_w, dot(w, difference));
  const V Sy = hn::Mul(broadcast(1 - 2 * share), hn::Mul(uu, by_w));  // −(b1 + c1)·Y
  const V minus_alpha = hn::MulAdd(G, Ex, hn::Mul(T, Ey)), beta = hn::MulSub(G, Ey, hn::Mul(T, Ex));
  const V gamma = hn::Mul(half, hn::MulAdd(Ex, Dy, hn::Mul(Ey, hn::MulSub(broadcast(slope), Sy, Dx))));
  const V norm = hn::MulAdd(beta, beta, hn::Mul(minus_alpha, minus_alpha));
  const V rho2[] = {hn::NegMulAdd(gamma, gamma, norm)};
  V by_rho[1];
  inverse_roots(rho2, by_rho);
  const V rho = hn::Mul(rho2[0], by_rho[0]), minus_by_norm = hn::Div(broadcast(-1), norm);
  const V sine = hn::Mul(minus_by_norm, hn::MulAdd(minus_alpha, gamma, hn::Mul(beta, rho)));
  const V cosine = hn::Mul(minus_by_norm, hn::MulSub(minus_alpha, rho, hn::Mul(beta, gamma)));

  // Half of the displacements of the sum and of the difference.
  const V3 middle = mul_add(hn::Mul(by_u, hn::Mul(B, sine)), u,
                            hn::Mul(by_w, hn::NegMulAdd(B, cosine, hn::Mul(half, Sy))) * w);
  const V3 apart =
      mul_add(hn::Mul(by_u, hn::MulSub(T, sine, hn::MulAdd(C, cosine, hn::Mul(half, Dx)))), u,
              hn::Mul(hn::Neg(by_w), hn::MulAdd(C, sine, hn::MulAdd(T, cosine, hn::Mul(half, Dy)))) * w);
  const V3 a = broadcast(-2 * inv_a / inv_h) * middle, b = middle + apart, c = middle - apart;
  shift = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
  const V all = hn::Add(hn::Add(sine, cosine), by_u);
  return hn::Eq(hn::Sub(all, all), hn::Zero(D()));
}

HWY_INLINE void settle_part(const SettleBatch& batch, const SettleStep& step, const Part& part,
                            SolveStats& stats) {
  HWY_ALIGN double copies[2][9 * kWidth];
  const Nines nines(part);
  double *x = nines.open(step.x, copies[0]), *v = nines.open(step.v, copies[1]);
  const Sides now = sides(rows_of(load_nine(x))), rate = sides(rows_of(load_nine(v)));
  Nine rows;
  const M found = settle_triangles(batch, now, mul_add(broadcast(-step.h), rate, now), rows);
  if (!hn::AllTrue(D(), found)) {
    const int lane = part.first_lane + static_cast<int>(hn::FindFirstTrue(D(), hn::Not(found)));
    stats.beside({.worst_bond = batch.lanes.bond(part.group, 0, lane), .failure = Failure::kShapeLost});
    return;
  }
  const V by_h = broadcast(1 / step.h);
  const Nine shifts = numbers_of(rows);
  for (int k = 0; k < 9; ++k) {
    double *x_k = x + k * kWidth, *v_k = v + k * kWidth;
    store_any(hn::Add(load_any(x_k), shifts.n[k]), x_k);
    store_any(hn::MulAdd(by_h, shifts.n[k], load_any(v_k)), v_k);
  }
  nines.close(x, step.x);
  nines.close(v, step.v);
}

template <class Shape>
struct SettleVelocityKernel : VelocityKernel<Shape> {
  HWY_INLINE SettleVelocityKernel(const Shape its_shape, SettleBatch& batch, const VelocityStep& its_step,
                                  const Part& its_part, Scratch& scratch)
      : VelocityKernel<Shape>(its_shape, batch.lambda, its_step, its_part, equations(its_shape, scratch),
                              scratch) {}
};

SolveStats settle_positions(SettleBatch& batch, const SettleStep& step, int begin, int end, const Scratch&) {
  SolveStats stats{.iterations = 1};
  for (int g = begin; g < end; ++g)
    for (int l = 0; l < batch.lanes.filled(g); l += kWidth)
      settle_part(batch, step, Part{batch.lanes, g, l}, stats);
  return stats;
}

SolveStats settle_velocities(SettleBatch& batch, const VelocityStep& step, const SolveCall& call, int begin,
                             int end, const Scratch& scratch) {
  if (batch.lanes.triangle)
    return solve_triangles<SettleVelocityKernel>(
        batch, step, {begin, end, scratch}, [&](const Part& part, SolveStats& stats) HWY_ATTR {
          return solve_velocities(batch.lanes, batch.lambda, step, part, stats);
        });
  return solve_groups<SettleVelocityKernel>(batch, step, call, begin, end, scratch);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(settle_positions);
HWY_EXPORT(settle_velocities);

Batched<Settle>::Batched(const System& sys, const Options& options, double h)
    : BatchedMethod(sys, options, h, {}) {
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

SolveStats Batched<Settle>::project_positions(const System&, double h, State& s) {
  const SettleStep step{h, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(settle_positions), step);
}

SolveStats Batched<Settle>::project_velocities(const System&, double h, State& s) {
  const VelocityStep step{h, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(settle_velocities), step, SolveCall{});
}

std::string Batched<Settle>::setting() const {
  int waters = 0;
  for (const SettleBatch& batch : batches_) waters += batch.lanes.clusters;
  return fmt::format("{} waters", waters);
}

}  // namespace taut
#endif
