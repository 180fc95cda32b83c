// The matrix of a group and its elimination, one cluster per lane. Compiled once for each SIMD target.
#if defined(TAUT_ELIMINATION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_ELIMINATION_INL_H
#undef TAUT_ELIMINATION_INL_H
#else
#define TAUT_ELIMINATION_INL_H
#endif

#include "constraints/batch/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// A factored matrix; elimination.hpp has the loops. Its rows are the diagonal, the inverse of the diagonal
// after elimination, the entries below the diagonal, and, if A is not symmetric, those above it.
struct Matrix {
  double *d, *inv_d;
  double *l, *u;
};

// Returns entry p of A in column k, ±(r_row·r_k)/m; 0 for fill. With left and right bond vectors of different
// times it is the entry of A' below the diagonal; with the two exchanged, the one above it.
template <class Shape>
HWY_INLINE V entry(const Shape shape, int p, const V3& r_k, const double* r) {
  return shape.signed_inv_mass(p) * dot(load3(r + 3 * shape.row(p)), r_k);
}

// row −= a b
HWY_INLINE void subtract(V a, V b, double* row) {
  store(hn::NegMulAdd(a, b, load(row)), row);
}

template <class Shape>
HWY_INLINE void couple(const Shape shape, const double* left, const double* right, double* entries) {
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r_k = load3(right + 3 * k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p)
      store(entry(shape, p, r_k, left), entries + p * kLanes);
  }
}

// Factors A of the bonds r, whose diagonal is given, into L D Lᵀ, and applies the forward substitution to b.
// Returns the lanes in which every pivot exceeds the threshold for dependent bonds; a NaN does not.
template <class Shape>
HWY_INLINE M eliminate(const Shape shape, const Matrix A, const double* r, double* b) {
  if constexpr (Shape::kUpdates) couple(shape, r, r, A.l);
  M regular = all_lanes();
  int update = 0;
  for (int k = 0; k < shape.eliminated(); ++k) {
    const V d = load(A.d + k * kLanes), inv = 1 / d, b_k = load(b + k * kLanes);
    regular = hn::And(regular, d > shape.bonds[k].least_pivot);
    store(inv, A.inv_d + k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p) {
      V c;
      if constexpr (Shape::kUpdates)
        c = load(A.l + p * kLanes);
      else
        c = entry(shape, p, load3(r + 3 * k * kLanes), r);
      const V l = c * inv;
      if constexpr (Shape::kUpdates) {
        for (int q = p + 1; q < shape.end(k); ++q)
          subtract(l, load(A.l + q * kLanes), A.l + shape.update(update++));
      }
      store(l, A.l + p * kLanes);
      subtract(l, c, A.d + shape.row(p));
      subtract(l, b_k, b + shape.row(p));
    }
  }
  return regular;
}

// Factors A' of the bonds r_next and r into L D U, otherwise as above. On return u is a unit upper triangle. A pivot may be
// negative: the bonds have passed a placement in which they depend on each other. A bond that has turned by 90° or more
// counts as one without a pivot.
template <class Shape>
HWY_INLINE M eliminate_turned(const Shape shape, const Matrix A, const double* r_next, const double* r,
                              double* b) {
  if constexpr (Shape::kUpdates) {
    couple(shape, r_next, r, A.l);
    couple(shape, r, r_next, A.u);
  }
  M regular = all_lanes();
  for (int k = 0; k < shape.eliminated(); ++k) regular = hn::And(regular, load(A.d + k * kLanes) > 0);
  int update = 0;
  for (int k = 0; k < shape.eliminated(); ++k) {
    const V d = load(A.d + k * kLanes), inv = 1 / d, b_k = load(b + k * kLanes);
    regular = hn::And(regular, hn::Abs(d) > shape.bonds[k].least_pivot);
    store(inv, A.inv_d + k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p) {
      V below, above;
      if constexpr (Shape::kUpdates) {
        below = load(A.l + p * kLanes);
        above = load(A.u + p * kLanes);
      } else {
        below = entry(shape, p, load3(r + 3 * k * kLanes), r_next);
        above = entry(shape, p, load3(r_next + 3 * k * kLanes), r);
      }
      const V l = below * inv, u = above * inv;
      if constexpr (Shape::kUpdates) {
        for (int q = p + 1; q < shape.end(k); ++q, ++update) {
          subtract(load(A.l + q * kLanes), u, A.l + shape.update(update));
          subtract(l, load(A.u + q * kLanes), A.u + shape.update(update));
        }
      }
      store(l, A.l + p * kLanes);
      store(u, A.u + p * kLanes);
      subtract(l, above, A.d + shape.row(p));
      subtract(l, b_k, b + shape.row(p));
    }
  }
  return regular;
}

// Reports a bond whose pivot vanished. Returns false if there is one.
HWY_INLINE bool accept(const Part& part, M regular, const double* d, SolveStats& stats) {
  if (hn::AllTrue(D(), regular)) return true;
  stats.failure = Failure::kSingular;
  for (int k = part.batch.plan.eliminated - 1; k >= 0; --k)
    for (int l = kWidth - 1; l >= 0; --l)
      if (!(d[k * kLanes + l] > part.batch.bonds[k].least_pivot))
        stats.worst_bond = part.batch.bond(part.group, k, part.first_lane + l);
  return false;
}

// b ← L⁻¹b for a chain, from both ends at once: bond k contributes to bond k + 2, and the last but one to the
// last. The running values stay in registers, because a round trip through memory would add ten cycles each.
HWY_INLINE void substitute_forward(const ChainShape shape, const double* l, double* b) {
  const int last = shape.size() - 1;
  if (last < 1) return;
  V here = load(b), next = load(b + kLanes);  // b_k, b_{k+1}
  for (int k = 0; k + 2 <= last; ++k) {
    double* b_p = b + (k + 2) * kLanes;
    const V after = load(b_p) - load(l + k * kLanes) * here;
    store(after, b_p);
    here = next;
    next = after;
  }
  store(next - load(l + (last - 1) * kLanes) * here, b + last * kLanes);
}

// b ← U⁻¹D⁻¹b for a chain
HWY_INLINE void substitute_back(const ChainShape shape, const double* inv_d, const double* u, double* b) {
  const auto scaled = [&](int k) HWY_ATTR { return load(b + k * kLanes) * load(inv_d + k * kLanes); };
  int k = shape.size() - 1;
  V after = scaled(k), next = after;  // b_{k+2}, b_{k+1}; at the last but one bond both are the last
  store(after, b + k * kLanes);
  for (--k; k >= 0; --k) {
    const V z = scaled(k) - load(u + k * kLanes) * after;
    store(z, b + k * kLanes);
    after = next;
    next = z;
  }
}

// b ← L⁻¹b
template <class Shape>
HWY_INLINE void substitute_forward(const Shape shape, const double* l, double* b) {
  for (int k = 0; k < shape.eliminated(); ++k) {
    const V b_k = load(b + k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p) subtract(load(l + p * kLanes), b_k, b + shape.row(p));
  }
}

// b ← U⁻¹D⁻¹b, u unit upper triangular by rows
template <class Shape>
HWY_INLINE void substitute_back(const Shape shape, const double* inv_d, const double* u, double* b) {
  for (int k = shape.eliminated() - 1; k >= 0; --k) {
    V z = load(b + k * kLanes) * load(inv_d + k * kLanes);
    for (int p = shape.begin(k); p < shape.end(k); ++p)
      z = hn::NegMulAdd(load(u + p * kLanes), load(b + shape.row(p)), z);
    store(z, b + k * kLanes);
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
