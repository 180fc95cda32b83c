#include "constraints/batch/batched_lincs.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_lincs.cpp"
#include <hwy/foreach_target.h>

#include "constraints/batch/lanes-inl.hpp"

#ifndef TAUT_LINCS_STEP
#define TAUT_LINCS_STEP
namespace taut {
struct LincsStep {
  double h;
  Lincs::Options options;
  double *x, *v;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// The letters are those of lincs.hpp.
struct LincsRows {
  double *x, *v;                      // 3 × atoms
  double *B, *rhs, *power, *sum, *g;  // B: 3 × bonds, others: bonds
  double* C;                          // entries below the diagonal

  HWY_INLINE LincsRows(const auto shape, Scratch scratch)
      : x(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        B(scratch.take(3 * shape.size())),
        rhs(scratch.take(shape.size())),
        power(scratch.take(shape.size())),
        sum(scratch.take(shape.size())),
        g(scratch.take(shape.size())),
        C(scratch.take(shape.entries())) {}
};

// Returns the direction of bond k.
template <class Shape>
HWY_INLINE V3 set_direction(const Shape, int k, const V3& r, const LincsRows& rows) {
  const V3 direction = 1 / hn::Sqrt(dot(r, r)) * r;
  store3(direction, rows.B + 3 * k * kLanes);
  return direction;
}

// C = I − S B M⁻¹Bᵀ S, whose diagonal is zero; g = 0
template <class Shape>
HWY_INLINE void find_coupling(const Shape shape, const double* scale, const LincsRows& rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V3 b_k = load3(rows.B + 3 * k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p) {
      const double weight = -shape.signed_inv_mass(p) * scale[k] * scale[shape.row(p) / kLanes];
      store(weight * dot(load3(rows.B + 3 * shape.row(p)), b_k), rows.C + p * kLanes);
    }
    store(hn::Zero(D()), rows.g + k * kLanes);
  }
}

// power = C·rhs, with the couplings inside triangles alone if `inside` is given; sum += power
template <class Shape>
HWY_INLINE void multiply(const Shape shape, const LincsRows& rows, const char* inside, const double* rhs,
                         double* power) {
  for (int k = 0; k < shape.size(); ++k) store(hn::Zero(D()), power + k * kLanes);
  for (int k = 0; k < shape.size(); ++k) {
    const V rhs_k = load(rhs + k * kLanes);
    V power_k = load(power + k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p) {
      if (inside && !inside[p]) continue;
      const V c = load(rows.C + p * kLanes);
      power_k += c * load(rhs + shape.row(p));
      store(c * rhs_k + load(power + shape.row(p)), power + shape.row(p));
    }
    store(power_k, power + k * kLanes);
    store(load(rows.sum + k * kLanes) + power_k, rows.sum + k * kLanes);
  }
}

// y −= M⁻¹BᵀS (I − C)⁻¹ rhs; g changes by the same multipliers
template <class Shape>
HWY_INLINE void apply(const Shape shape, const LincsBatch& batch, int order, const LincsRows& rows,
                      double* y) {
  for (int k = 0; k < shape.size(); ++k) store(load(rows.rhs + k * kLanes), rows.sum + k * kLanes);
  double *rhs = rows.rhs, *power = rows.power;
  for (int n = 0; n < (batch.triangles ? 2 * order : order); ++n) {
    multiply(shape, rows, n < order ? nullptr : batch.inside.data(), rhs, power);
    std::swap(rhs, power);
  }
  for (int k = 0; k < shape.size(); ++k) {
    const V dg = -batch.scale[k] * load(rows.sum + k * kLanes);
    store(load(rows.g + k * kLanes) + dg, rows.g + k * kLanes);
    add_constraint_acceleration(shape, k, dg, load3(rows.B + 3 * k * kLanes), y);
  }
}

// Computes how much longer than d the bonds have become by rotation.
template <class Shape>
HWY_INLINE Worst find_lengthening(const Shape shape, const LincsBatch& batch, const LincsRows& rows) {
  Worst worst;
  for (int k = 0; k < shape.size(); ++k) {
    const LaneBond& bond = shape.bonds[k];
    const V3 r = difference(shape, k, rows.x);
    const V square = dot(r, r);
    worst.include(bond, square - bond.length2);
    const V rest = hn::Max(hn::Zero(D()), 2 * bond.length2 - square);
    store(batch.scale[k] * (batch.length[k] - hn::Sqrt(rest)), rows.rhs + k * kLanes);
  }
  return worst;
}

template <class Shape>
HWY_INLINE void lincs_positions_of(const Shape shape, LincsBatch& batch, const LincsStep& step,
                                   const Part& part, const Scratch& scratch, SolveStats& stats) {
  const LincsRows rows(shape, scratch);
  const double* scale = batch.scale.data();
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    const V3 direction = set_direction(shape, k, r - step.h * difference(shape, k, rows.v), rows);
    store(scale[k] * (dot(direction, r) - batch.length[k]), rows.rhs + k * kLanes);
  }
  find_coupling(shape, scale, rows);
  apply(shape, batch, step.options.order, rows, rows.x);
  Worst worst = find_lengthening(shape, batch, rows);
  for (int n = 0; n < step.options.iterations; ++n) {
    apply(shape, batch, step.options.order, rows, rows.x);
    worst = find_lengthening(shape, batch, rows);
  }
  for (int k = 0; k < shape.size(); ++k)
    add_constraint_acceleration(shape, k, 1 / step.h * load(rows.g + k * kLanes),
                                load3(rows.B + 3 * k * kLanes), rows.v);
  scatter(shape, part, rows.x, step.x);
  scatter(shape, part, rows.v, step.v);
  if (worst.within(stats.max_residual)) return;  // a larger one is known
  find_residuals(part.batch, rows.x, rows.rhs);
  record_largest(part, rows.rhs, stats);
}

template <class Shape>
HWY_INLINE void lincs_velocities_of(const Shape shape, LincsBatch& batch, const LincsStep& step,
                                    const Part& part, const Scratch& scratch) {
  const LincsRows rows(shape, scratch);
  const double* scale = batch.scale.data();
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  for (int k = 0; k < shape.size(); ++k) {
    const V3 direction = set_direction(shape, k, difference(shape, k, rows.x), rows);
    store(scale[k] * dot(direction, difference(shape, k, rows.v)), rows.rhs + k * kLanes);
  }
  find_coupling(shape, scale, rows);
  apply(shape, batch, step.options.order, rows, rows.v);
  for (int k = 0; k < shape.size(); ++k)
    store(2 / (step.h * batch.length[k]) * load(rows.g + k * kLanes), lambda + k * kLanes);
  scatter(shape, part, rows.v, step.v);
}

SolveStats lincs_positions(LincsBatch& batch, const LincsStep& step, int begin, int end,
                           const Scratch& scratch) {
  SolveStats stats{.iterations = step.options.iterations + 1};
  for_each_part(batch.lanes, begin, end, scratch,
                [&](auto shape, const Part& part, const Scratch& rows)
                    HWY_ATTR { lincs_positions_of(shape, batch, step, part, rows, stats); });
  return stats;
}

SolveStats lincs_velocities(LincsBatch& batch, const LincsStep& step, int begin, int end,
                            const Scratch& scratch) {
  for_each_part(batch.lanes, begin, end, scratch,
                [&](auto shape, const Part& part, const Scratch& rows)
                    HWY_ATTR { lincs_velocities_of(shape, batch, step, part, rows); });
  return {.iterations = 1};
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(lincs_positions);
HWY_EXPORT(lincs_velocities);

LincsBatch::LincsBatch(const ClusterBatch& batch) : lanes(batch), lambda(rows_of_bonds(lanes)) {
  std::vector<RigidBond> bonds;  // in the order of the kernel
  for (const LaneBond& bond : lanes.bonds) {
    length.push_back(std::sqrt(bond.length2));
    scale.push_back(1 / std::sqrt(bond.reduced_inv_mass));
    bonds.push_back(
        {static_cast<int>(bond.i) / (3 * kLanes), static_cast<int>(bond.j) / (3 * kLanes), length.back()});
  }
  const BondTriangles sides(bonds);
  for (int k = 0; k < lanes.bond_count(); ++k)
    for (int p = lanes.plan.column_start[k]; p < lanes.plan.column_start[k + 1]; ++p)
      inside.push_back(sides.hold(bonds[k], bonds[lanes.plan.row[p] / kLanes]));
  triangles = std::ranges::find(inside, 1) != inside.end();
}

Batched<Lincs>::Batched(const System& sys, const Options& options, double h)
    : BatchedMethod(sys, options, h, find_clusters(sys)) {}

SolveStats Batched<Lincs>::project_positions(const System&, double h, State& s) {
  const LincsStep step{h, options_, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(lincs_positions), step).beside(leftover_.project_positions(h, s));
}

SolveStats Batched<Lincs>::project_velocities(const System&, double h, State& s) {
  const LincsStep step{h, options_, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(lincs_velocities), step)
      .beside(leftover_.project_velocities(h, s));
}

}  // namespace taut
#endif
