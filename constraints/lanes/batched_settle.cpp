#include "constraints/lanes/batched_settle.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/lanes/batched_settle.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes/velocities-inl.hpp"

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

HWY_INLINE V3 normalized(const V3& a) {
  return hn::Div(broadcast(1), hn::Sqrt(dot(a, a))) * a;
}
HWY_INLINE V cosine(V sine) {
  return hn::Sqrt(hn::NegMulAdd(sine, sine, broadcast(1)));
}
// x·X' + y·Y' + z·Z'
HWY_INLINE V3 along(V x, const V3& X, V y, const V3& Y, V z, const V3& Z) {
  return mul_add(x, X, mul_add(y, Y, z * Z));
}

// settle.cpp has the derivation and the names: 0 before the step, 1 drifted, 2 after φ and ψ, 3 after θ.
void settle_positions_of(const SettleBatch& batch, const SettleStep& step, const Part& part, Scratch scratch,
                         SolveStats& stats) {
  constexpr int a = 0, b = 3 * kLanes, c = 6 * kLanes;  // rows of apex, left, right
  double *x = scratch.take(9), *v = scratch.take(9);
  gather(part, 3, step.x, x);
  gather(part, 3, step.v, v);
  // the hydrogen's share of the mass
  const V share = broadcast(1 / (2 + batch.lanes.inv_mass[1] / batch.lanes.inv_mass[0])),
          h = broadcast(step.h);
  const V ra = broadcast(batch.ra), rb = broadcast(batch.rb), rc = broadcast(batch.rc);

  const V3 left = load3(x + b) - load3(x + a), right = load3(x + c) - load3(x + a), v_a = load3(v + a);
  const V3 b0 = neg_mul_add(h, load3(v + b) - v_a, left), c0 = neg_mul_add(h, load3(v + c) - v_a, right);
  const V3 centre = share * (left + right);
  const V3 a1 = -centre, b1 = left - centre, c1 = right - centre;

  const V3 Z = normalized(cross(b0, c0)), X = normalized(cross(a1, Z)), Y = cross(Z, X);
  const V xb0 = dot(X, b0), yb0 = dot(Y, b0), xc0 = dot(X, c0), yc0 = dot(Y, c0);
  const V za1 = dot(Z, a1), xb1 = dot(X, b1), yb1 = dot(Y, b1), zb1 = dot(Z, b1);
  const V xc1 = dot(X, c1), yc1 = dot(Y, c1), zc1 = dot(Z, c1);

  const V sin_phi = hn::Mul(za1, broadcast(1 / batch.ra)), cos_phi = cosine(sin_phi);
  const V sin_psi = hn::Div(hn::Sub(zb1, zc1), hn::Mul(hn::Add(rc, rc), cos_phi)), cos_psi = cosine(sin_psi);
  const V ya2 = hn::Mul(ra, cos_phi), xb2 = hn::Neg(hn::Mul(rc, cos_psi));
  const V tilt = hn::Mul(hn::Mul(rc, sin_psi), sin_phi), base = hn::Neg(hn::Mul(rb, cos_phi));
  const V yb2 = hn::Sub(base, tilt), yc2 = hn::Add(base, tilt);

  const V alpha = hn::MulAdd(xb2, hn::Sub(xb0, xc0), hn::MulAdd(yb0, yb2, hn::Mul(yc0, yc2)));
  const V beta = hn::MulAdd(xb2, hn::Sub(yc0, yb0), hn::MulAdd(xb0, yb2, hn::Mul(xc0, yc2)));
  const V gamma = hn::Add(hn::MulSub(xb0, yb1, hn::Mul(xb1, yb0)), hn::MulSub(xc0, yc1, hn::Mul(xc1, yc0)));
  const V norm = hn::MulAdd(alpha, alpha, hn::Mul(beta, beta));
  const V root = hn::Sqrt(hn::NegMulAdd(gamma, gamma, norm));
  const V sin_theta = hn::Div(hn::MulSub(alpha, gamma, hn::Mul(beta, root)), norm),
          cos_theta = cosine(sin_theta);

  const V sum = hn::Add(hn::Add(sin_theta, cos_theta), cos_psi);
  const auto found = hn::Eq(hn::Sub(sum, sum), hn::Zero(D()));
  if (!hn::AllTrue(D(), found)) {
    const int lane = part.first_lane + static_cast<int>(hn::FindFirstTrue(D(), hn::Not(found)));
    stats.beside({.worst_bond = batch.lanes.bond(part.group, 0, lane), .failure = Failure::kShapeLost});
    return;
  }
  const V3 a3 = along(hn::Neg(hn::Mul(ya2, sin_theta)), X, hn::Mul(ya2, cos_theta), Y, za1, Z);
  const V3 b3 = along(hn::MulSub(xb2, cos_theta, hn::Mul(yb2, sin_theta)), X,
                      hn::MulAdd(xb2, sin_theta, hn::Mul(yb2, cos_theta)), Y, zb1, Z);
  const V3 c3 = along(hn::Neg(hn::MulAdd(xb2, cos_theta, hn::Mul(yc2, sin_theta))), X,
                      hn::MulSub(yc2, cos_theta, hn::Mul(xb2, sin_theta)), Y, zc1, Z);
  const V inv_h = broadcast(1 / step.h);
  const V3 shifts[] = {a3 - a1, b3 - b1, c3 - c1};
  for (int n = 0; n < 3; ++n) {
    double *x_n = x + 3 * n * kLanes, *v_n = v + 3 * n * kLanes;
    store3(load3(x_n) + shifts[n], x_n);
    store3(mul_add(inv_h, shifts[n], load3(v_n)), v_n);
  }
  scatter(part, 0, 3, x, step.x);
  scatter(part, 0, 3, v, step.v);
}

template <class Shape>
struct SettleVelocityKernel : VelocityKernel<Shape> {
  HWY_INLINE SettleVelocityKernel(const Shape its_shape, SettleBatch& batch, const VelocityStep& its_step,
                                  const Part& its_part, Scratch& scratch)
      : VelocityKernel<Shape>(its_shape, batch.lambda, its_step, its_part, equations(its_shape, scratch),
                              scratch) {}
};

SolveStats settle_positions(SettleBatch& batch, const SettleStep& step, int begin, int end,
                            const Scratch& scratch) {
  SolveStats stats{.iterations = 1};
  for_each_part(batch.lanes, begin, end, scratch, [&](auto, const Part& part, const Scratch& rows) HWY_ATTR {
    settle_positions_of(batch, step, part, rows, stats);
  });
  return stats;
}

SolveStats settle_velocities(SettleBatch& batch, const VelocityStep& step, const SolveCall& call, int begin,
                             int end, const Scratch& scratch) {
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
