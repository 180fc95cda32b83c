#include "constraints/batched_baumgarte.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batched_baumgarte.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Scratch of one part.
struct BaumgarteRows {
  double *x, *v, *f;  // of the atoms
  double *r, *b;      // of the bonds
  Matrix A;
};

HWY_INLINE BaumgarteRows rows_in(const BaumgarteBatch& batch, double* scratch) {
  const int atoms = 3 * batch.lanes.atoms * kWidth, bonds = batch.plan.size() * kWidth;
  double *r = scratch + 3 * atoms, *b = r + 3 * bonds;
  return {scratch,
          scratch + atoms,
          scratch + 2 * atoms,
          r,
          b,
          {batch.plan, b + bonds, b + 2 * bonds, b + 3 * bonds, nullptr}};
}

// f += Jᵀλ*; λ becomes λ*, before becomes λ. r is found on the way.
HWY_INLINE void apply_guess(const BaumgarteBatch& batch, double guess, double* lambda, double* before,
                            const BaumgarteRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  for (int k = 0; k < n; ++k) {
    const LaneBond& bond = bonds[k];
    const V3 r = load3(rows.x + bond.j * kWidth) - load3(rows.x + bond.i * kWidth);
    store3(r, rows.r + 3 * k * kWidth);
    const V last = load(lambda + k * kLanes);
    const V guessed = hn::MulAdd(all(guess), hn::Sub(last, load(before + k * kLanes)), last);
    store(last, before + k * kLanes);
    store(guessed, lambda + k * kLanes);
    pull(bond, guessed, r, rows.f);
  }
}

// b, the right-hand side for λ − λ*; if asked, also A's diagonal and the residuals.
template <bool kFirst>
HWY_INLINE void right_hand_side(const BaumgarteBatch& batch, double h, const BaumgarteRows rows,
                                Worst& worst) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  const BaumgarteTerms* terms_of = batch.terms.data();
  for (int k = 0; k < n; ++k) {
    const LaneBond& bond = bonds[k];
    const BaumgarteTerms& terms = terms_of[k];
    const V3 r = load3(rows.r + 3 * k * kWidth);
    const V3 a = neg_mul_add(all(bond.inv_mass_i), load3(rows.f + bond.i * kWidth),
                             all(bond.inv_mass_j) * load3(rows.f + bond.j * kWidth));
    const V3 v_half = load3(rows.v + bond.j * kWidth) - load3(rows.v + bond.i * kWidth);
    const V3 w = mul_add(all(0.5 * h), a, v_half);
    const V rr = dot(r, r), offset = hn::Sub(rr, all(bond.length2));
    V b = hn::Mul(all(terms.rate_a), dot(r, a));
    b = hn::MulAdd(all(terms.rate_v), dot(r, w), b);
    b = hn::MulAdd(all(terms.square_v), dot(w, w), b);
    b = hn::MulAdd(all(terms.cross), dot(w, a), b);
    b = hn::MulAdd(all(terms.offset), offset, b);
    store(hn::Neg(b), rows.b + k * kWidth);
    if constexpr (kFirst) {
      worst.see(hn::Mul(hn::Abs(offset), all(bond.half_inv_length2)));
      store(hn::Mul(all(bond.reduced_inv_mass), rr), rows.A.d + k * kWidth);
    }
  }
}

// λ += Δλ, f += JᵀΔλ
HWY_INLINE void apply(const BaumgarteBatch& batch, double* lambda, const BaumgarteRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  for (int k = 0; k < n; ++k) {
    const V change = load(rows.b + k * kWidth);
    store(hn::Add(load(lambda + k * kLanes), change), lambda + k * kLanes);
    pull(bonds[k], change, load3(rows.r + 3 * k * kWidth), rows.f);
  }
}

void baumgarte_part(BaumgarteBatch& batch, const BaumgarteStep& step, const Part& part, double* scratch,
                    SolveStats& stats) {
  const BaumgarteRows rows = rows_in(batch, scratch);
  double *lambda = batch.lambda.of(part.group) + part.first_lane,
         *before = batch.before.of(part.group) + part.first_lane;
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  gather(part, step.f, rows.f);
  apply_guess(batch, step.guess, lambda, before, rows);
  Worst worst;
  right_hand_side<true>(batch, step.h, rows, worst);
  if (!worst.within(stats.max_residual)) {
    find_residuals(batch.lanes, rows.x, rows.A.inv_d);
    enter(part, rows.A.inv_d, stats);
  }
  couple(batch.plan, rows.r, rows.r, rows.A.l);
  if (!regular(part, eliminate(rows.A, batch.lanes.bonds.data(), rows.b), rows.A.d, stats)) return;
  substitute_back(batch.plan, rows.A.inv_d, rows.A.l, rows.b);
  apply(batch, lambda, rows);
  for (int pass = 1; pass < step.passes; ++pass) {
    right_hand_side<false>(batch, step.h, rows, worst);
    substitute_forward(batch.plan, rows.A.l, rows.b);
    substitute_back(batch.plan, rows.A.inv_d, rows.A.l, rows.b);
    apply(batch, lambda, rows);
  }
  scatter(part, rows.f, step.f);
}

SolveStats baumgarte_groups(BaumgarteBatch& batch, const BaumgarteStep& step, int begin, int end,
                            double* scratch) {
  SolveStats stats{.iterations = step.passes};
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { baumgarte_part(batch, step, part, scratch, stats); });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(baumgarte_groups);

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys, options.sweeps > 0 ? 0 : kMostBondsInLanes)) {}

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : damping_(damping_named(options.damping)),
      passes_(options.passes),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  const std::vector<Gains> gains = choose_gains(options.choice(), damping_, sys, h);
  setting_ = describe_baumgarte(options, gains, h);
  for (const ClusterBatch& batch : clusters.batches) {
    Elimination plan(batch.shape);
    LaneBatch lanes(batch, plan.order);
    std::vector<Gains> of_bonds;
    for (int k = 0; k < plan.size(); ++k) of_bonds.push_back(gains[lanes.bond(0, k, 0)]);
    std::vector<BaumgarteTerms> terms(of_bonds.size());
    LaneRows lambda(lanes.groups, plan.size()), before(lanes.groups, plan.size());
    batches_.push_back({std::move(lanes), std::move(plan), std::move(of_bonds), std::move(terms),
                        std::move(lambda), std::move(before)});
    runner_.add(batches_.back().lanes, scratch_rows(batches_.back().lanes, batches_.back().plan));
  }
}

void Batched<Baumgarte>::set_terms(double h) {
  if (h == h_of_terms_) return;
  h_of_terms_ = h;
  const bool lagged = damping_ == Damping::kLagged, centred = damping_ == Damping::kCentred;
  for (BaumgarteBatch& batch : batches_)
    for (std::size_t k = 0; k < batch.gains.size(); ++k) {
      const auto [alpha, beta] = batch.gains[k];
      const double q = lagged ? 1 : 1 + alpha * h;
      batch.terms[k] = {.rate_a = (lagged ? 1 - alpha * h : 1) / q,
                        .rate_v = 2 * alpha / q,
                        .square_v = 1 / q,
                        .cross = centred ? alpha * h * h / q : 0,
                        .offset = 0.5 * beta * beta / q};
    }
}

SolveStats Batched<Baumgarte>::add_forces(const System&, double h, State& s) {
  set_terms(h);
  const BaumgarteStep step{.h = h,
                           .guess = steps_ >= 2 ? 1.0 / 3 : 0.0,
                           .passes = passes_,
                           .x = s.x.data(),
                           .v = s.v.data(),
                           .f = s.f.data()};
  if (steps_ < 2) ++steps_;
  SolveStats stats = runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(baumgarte_groups)(batches_[b], step, begin, end, scratch);
  });
  LaneRunner::merge(stats, leftover_.add_forces(h, s));
  return stats;
}

const Eigen::VectorXd& Batched<Baumgarte>::lambda() const {
  for (const BaumgarteBatch& batch : batches_) rows_to_bonds(batch.lanes, batch.lambda, lambda_);
  leftover_.write_lambda(lambda_);
  return lambda_;
}

}  // namespace taut
#endif
