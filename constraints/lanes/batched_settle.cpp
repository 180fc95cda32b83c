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

// settle.cpp has the derivation and the names: 0 before the step, 1 drifted, 2 after φ and ψ, 3 after θ. Each
// root and division waits for the one before: so rows of waters go side by side, stage by stage.
struct Waters {
  V3 a1, b1, c1, X, Y, Z;
  V xb0, yb0, xc0, yc0, za1, zb1, zc1, gamma;  // along X, Y, Z
  V cos_psi, ya2, xb2, yb2, yc2;
};

HWY_INLINE void lay_axes(const SettleBatch& batch, double step, const double* x, const double* v, Waters& w) {
  constexpr int a = 0, b = 3 * kLanes, c = 6 * kLanes;  // rows of apex, left, right
  // the hydrogen's share of the mass
  const V share = broadcast(1 / (2 + batch.lanes.inv_mass[1] / batch.lanes.inv_mass[0])), h = broadcast(step);
  const V3 left = load3(x + b) - load3(x + a), right = load3(x + c) - load3(x + a), v_a = load3(v + a);
  const V3 b0 = neg_mul_add(h, load3(v + b) - v_a, left), c0 = neg_mul_add(h, load3(v + c) - v_a, right);
  const V3 centre = share * (left + right);
  w.a1 = -centre;
  w.b1 = left - centre;
  w.c1 = right - centre;

  w.Z = normalized(cross(b0, c0));
  w.X = normalized(cross(w.a1, w.Z));
  w.Y = cross(w.Z, w.X);
  w.xb0 = dot(w.X, b0);
  w.yb0 = dot(w.Y, b0);
  w.xc0 = dot(w.X, c0);
  w.yc0 = dot(w.Y, c0);
  w.za1 = dot(w.Z, w.a1);
  w.zb1 = dot(w.Z, w.b1);
  w.zc1 = dot(w.Z, w.c1);
  const V xb1 = dot(w.X, w.b1), yb1 = dot(w.Y, w.b1), xc1 = dot(w.X, w.c1), yc1 = dot(w.Y, w.c1);
  w.gamma = hn::Add(hn::MulSub(w.xb0, yb1, hn::Mul(xb1, w.yb0)), hn::MulSub(w.xc0, yc1, hn::Mul(xc1, w.yc0)));
}

HWY_INLINE void tilt_triangles(const SettleBatch& batch, Waters& w) {
  const V ra = broadcast(batch.ra), rb = broadcast(batch.rb), rc = broadcast(batch.rc);
  const V sin_phi = hn::Mul(w.za1, broadcast(1 / batch.ra)), cos_phi = cosine(sin_phi);
  const V sin_psi = hn::Div(hn::Sub(w.zb1, w.zc1), hn::Mul(hn::Add(rc, rc), cos_phi));
  w.cos_psi = cosine(sin_psi);
  w.ya2 = hn::Mul(ra, cos_phi);
  w.xb2 = hn::Neg(hn::Mul(rc, w.cos_psi));
  const V tilt = hn::Mul(hn::Mul(rc, sin_psi), sin_phi), base = hn::Neg(hn::Mul(rb, cos_phi));
  w.yb2 = hn::Sub(base, tilt);
  w.yc2 = hn::Add(base, tilt);
}

// Shifts the rows; where a lane has no solution, says which lanes have and leaves them.
HWY_INLINE M turn_triangles(double h, const Waters& w, double* x, double* v) {
  const V alpha = hn::MulAdd(w.xb2, hn::Sub(w.xb0, w.xc0), hn::MulAdd(w.yb0, w.yb2, hn::Mul(w.yc0, w.yc2)));
  const V beta = hn::MulAdd(w.xb2, hn::Sub(w.yc0, w.yb0), hn::MulAdd(w.xb0, w.yb2, hn::Mul(w.xc0, w.yc2)));
  const V norm = hn::MulAdd(alpha, alpha, hn::Mul(beta, beta));
  const V root = hn::Sqrt(hn::NegMulAdd(w.gamma, w.gamma, norm));
  const V sin_theta = hn::Div(hn::MulSub(alpha, w.gamma, hn::Mul(beta, root)), norm),
          cos_theta = cosine(sin_theta);

  const V sum = hn::Add(hn::Add(sin_theta, cos_theta), w.cos_psi);
  const M found = hn::Eq(hn::Sub(sum, sum), hn::Zero(D()));
  const V3 a3 = along(hn::Neg(hn::Mul(w.ya2, sin_theta)), w.X, hn::Mul(w.ya2, cos_theta), w.Y, w.za1, w.Z);
  const V3 b3 = along(hn::MulSub(w.xb2, cos_theta, hn::Mul(w.yb2, sin_theta)), w.X,
                      hn::MulAdd(w.xb2, sin_theta, hn::Mul(w.yb2, cos_theta)), w.Y, w.zb1, w.Z);
  const V3 c3 = along(hn::Neg(hn::MulAdd(w.xb2, cos_theta, hn::Mul(w.yc2, sin_theta))), w.X,
                      hn::MulSub(w.yc2, cos_theta, hn::Mul(w.xb2, sin_theta)), w.Y, w.zc1, w.Z);
  const V inv_h = broadcast(1 / h);
  const V3 shifts[] = {a3 - w.a1, b3 - w.b1, c3 - w.c1};
  for (int n = 0; n < 3; ++n) {
    double *x_n = x + 3 * n * kLanes, *v_n = v + 3 * n * kLanes;
    store3(load3(x_n) + shifts[n], x_n);
    store3(mul_add(inv_h, shifts[n], load3(v_n)), v_n);
  }
  return found;
}

// So many parts of groups, from one on.
template <int kParts>
HWY_INLINE void settle_positions_of(const SettleBatch& batch, const SettleStep& step,
                                    const Part (&parts)[kParts], SolveStats& stats) {
  HWY_ALIGN double x[kParts][9 * kLanes], v[kParts][9 * kLanes];
  Waters w[kParts];
  for (int p = 0; p < kParts; ++p) {
    gather(parts[p], 3, step.x, x[p]);
    gather(parts[p], 3, step.v, v[p]);
  }
  for (int p = 0; p < kParts; ++p) lay_axes(batch, step.h, x[p], v[p], w[p]);
  for (int p = 0; p < kParts; ++p) tilt_triangles(batch, w[p]);
  M found[kParts];
  for (int p = 0; p < kParts; ++p) found[p] = turn_triangles(step.h, w[p], x[p], v[p]);
  for (int p = 0; p < kParts; ++p) {
    const Part& part = parts[p];
    if (!hn::AllTrue(D(), found[p])) {
      const int lane = part.first_lane + static_cast<int>(hn::FindFirstTrue(D(), hn::Not(found[p])));
      stats.beside({.worst_bond = batch.lanes.bond(part.group, 0, lane), .failure = Failure::kShapeLost});
      continue;
    }
    scatter(part, 0, 3, x[p], step.x);
    scatter(part, 0, 3, v[p], step.v);
  }
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
  constexpr int kOfGroup = kLanes / kWidth;
  const int last = (batch.lanes.filled(end - 1) + kWidth - 1) / kWidth;  // parts of the last group
  const int parts = (end - 1 - begin) * kOfGroup + last;
  const auto part = [&](int n) { return Part{batch.lanes, begin + n / kOfGroup, n % kOfGroup * kWidth}; };
  int n = 0;
  for (; n + 2 <= parts; n += 2) settle_positions_of<2>(batch, step, {part(n), part(n + 1)}, stats);
  if (n < parts) settle_positions_of<1>(batch, step, {part(n)}, stats);
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
