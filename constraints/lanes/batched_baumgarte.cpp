#include "constraints/lanes/batched_baumgarte.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/lanes/batched_baumgarte.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes/elimination-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Scratch of one part.
struct BaumgarteRows {
  double *x, *v, *f;  // of the atoms
  double *r, *b;      // of the bonds
  Matrix A;
};

template <class Shape>
HWY_INLINE BaumgarteRows baumgarte_rows(const Shape shape, double* scratch) {
  const int atoms = 3 * shape.atoms() * kLanes, bonds = shape.size() * kLanes;
  double *r = scratch + 3 * atoms, *b = r + 3 * bonds;
  return {scratch,
          scratch + atoms,
          scratch + 2 * atoms,
          r,
          b,
          {b + bonds, b + 2 * bonds, b + 3 * bonds, nullptr}};
}

// f += Jᵀλ*; λ becomes λ*, before becomes λ. r is found on the way.
template <class Shape>
HWY_INLINE void apply_guess(const Shape shape, double guess, double* lambda, double* before,
                            const BaumgarteRows rows) {
  const V weight = all(guess);
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    const V last = load(lambda + k * kLanes);
    const V guessed = hn::MulAdd(weight, hn::Sub(last, load(before + k * kLanes)), last);
    store(last, before + k * kLanes);
    store(guessed, lambda + k * kLanes);
    pull(shape, k, guessed, r, rows.f);
  }
}

// b, the right-hand side for λ − λ*; the first time also A's diagonal and the residuals.
template <bool kFirst, class Shape>
HWY_INLINE void right_hand_side(const Shape shape, const BaumgarteTerms* terms_of, double h,
                                const BaumgarteRows rows, Worst& worst) {
  const V half_h = all(0.5 * h);
  for (int k = 0; k < shape.size(); ++k) {
    const LaneBond& bond = shape.bonds[k];
    const BaumgarteTerms& terms = terms_of[k];
    const V3 r = load3(rows.r + 3 * k * kLanes);
    const V3 a = neg_mul_add(all(bond.inv_mass_i), load3(rows.f + shape.i(k)),
                             all(bond.inv_mass_j) * load3(rows.f + shape.j(k)));
    const V3 w = mul_add(half_h, a, difference(shape, k, rows.v));
    const V rr = dot(r, r), offset = hn::Sub(rr, all(bond.length2));
    V b = hn::Mul(all(terms.rate_a), dot(r, a));
    b = hn::MulAdd(all(terms.rate_v), dot(r, w), b);
    b = hn::MulAdd(all(terms.square_v), dot(w, w), b);
    b = hn::MulAdd(all(terms.cross), dot(w, a), b);
    b = hn::MulAdd(all(terms.offset), offset, b);
    store(hn::Neg(b), rows.b + k * kLanes);
    if constexpr (kFirst) {
      worst.see(hn::Mul(hn::Abs(offset), all(bond.half_inv_length2)));
      store(hn::Mul(all(bond.reduced_inv_mass), rr), rows.A.d + k * kLanes);
    }
  }
}

// λ += Δλ, f += JᵀΔλ
template <class Shape>
HWY_INLINE void apply(const Shape shape, double* lambda, const BaumgarteRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V change = load(rows.b + k * kLanes);
    store(hn::Add(load(lambda + k * kLanes), change), lambda + k * kLanes);
    pull(shape, k, change, load3(rows.r + 3 * k * kLanes), rows.f);
  }
}

template <class Shape>
HWY_INLINE void baumgarte_part(const Shape shape, BaumgarteBatch& batch, const BaumgarteStep& step,
                               const Part& part, double* scratch, SolveStats& stats) {
  const BaumgarteRows rows = baumgarte_rows(shape, scratch);
  const BaumgarteTerms* terms = batch.terms.data();
  double *lambda = batch.lambda.of(part.group) + part.first_lane,
         *before = batch.before.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  gather(part, shape.atoms(), step.f, rows.f);
  apply_guess(shape, step.guess, lambda, before, rows);
  Worst worst;
  right_hand_side<true>(shape, terms, step.h, rows, worst);
  const V margin = eliminate(shape, rows.A, rows.r, rows.b);
  substitute_back(shape, rows.A.inv_d, rows.A.l, rows.b);
  apply(shape, lambda, rows);
  for (int pass = 1; pass < step.passes; ++pass) {
    right_hand_side<false>(shape, terms, step.h, rows, worst);
    substitute_forward(shape, rows.A.l, rows.b);
    substitute_back(shape, rows.A.inv_d, rows.A.l, rows.b);
    apply(shape, lambda, rows);
  }
  scatter(part, shape.atoms(), rows.f, step.f);
  if (!worst.within(stats.max_residual)) {
    find_residuals(part.batch, rows.x, rows.b);
    enter(part, rows.b, stats);
  }
  regular(part, margin, rows.A.d, stats);
}

SolveStats baumgarte_groups(BaumgarteBatch& batch, const BaumgarteStep& step, int begin, int end,
                            double* scratch) {
  SolveStats stats{.iterations = step.passes};
  for_each_part(batch.lanes, begin, end, scratch, [&](auto shape, const Part& part, double* rows) HWY_ATTR {
    baumgarte_part(shape, batch, step, part, rows, stats);
  });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(baumgarte_groups);

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h,
              find_clusters(sys, options.sweeps > 0 ? ClusterLimits{0, 0} : ClusterLimits{})) {}

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : damping_(damping_named(options.damping)),
      passes_(options.passes),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  const std::vector<Gains> gains = choose_gains(options.choice(), damping_, sys, h);
  setting_ = describe_baumgarte(options, gains, h);
  for (const ClusterBatch& batch : clusters.batches) {
    LaneBatch lanes(batch);
    std::vector<Gains> of_bonds;
    for (int k = 0; k < lanes.bond_count(); ++k) of_bonds.push_back(gains[lanes.bond(0, k, 0)]);
    std::vector<BaumgarteTerms> terms(of_bonds.size());
    LaneRows lambda = rows_of_bonds(lanes), before = rows_of_bonds(lanes);
    runner_.add(lanes);
    batches_.push_back(
        {std::move(lanes), std::move(of_bonds), std::move(terms), std::move(lambda), std::move(before)});
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
