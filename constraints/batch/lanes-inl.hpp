// Functions that all kernels share. Compiled once for each SIMD target (Highway's foreach_target).
#if defined(TAUT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_LANES_INL_H
#undef TAUT_LANES_INL_H
#else
#define TAUT_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <utility>

#include "base/vector_lanes-inl.hpp"
#include "constraints/batch/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

static_assert(kWidth <= kLanes);

// The lanes in which a condition holds. Conditions are combined by And, so that a NaN fails them; Min and Max
// would drop it.
using M = hn::Mask<D>;
HWY_INLINE M all_lanes() {
  return broadcast(0) == 0;
}

// Loads and stores three consecutive rows: a 3-vector of each cluster.
HWY_INLINE V3 load3(const double* rows) {
  return {load(rows), load(rows + kLanes), load(rows + 2 * kLanes)};
}
HWY_INLINE void store3(const V3& a, double* rows) {
  store(a.x, rows);
  store(a.y, rows + kLanes);
  store(a.z, rows + 2 * kLanes);
}

// The lanes of a group that a vector of this target holds, from first_lane on.
struct Part {
  const LaneBatch& batch;
  int group, first_lane;

  const int* places() const { return batch.places(group) + first_lane; }
};

// Loading and storing transposes square blocks of kWidth × kWidth numbers: lane l is a stretch of memory of
// its own, row n is the n-th number of each stretch. The transposition has three levels: halves of vectors by
// the addresses that are read or written, 16-byte blocks by swapping, neighbours by interleaving. (A gather
// of 8 takes 15 cycles on Zen 5, a row of a block 1.5.)
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void load_block(const double* array, const int* place, V* t) {
  t[0] = load(array + place[0]);
}
HWY_INLINE void store_block(const V* t, double* array, const int* place) {
  store(t[0], array + place[0]);
}
template <int>
HWY_INLINE V load_each(const double* array, const int* place) {
  return load(array + place[0]);
}
template <int>
HWY_INLINE void store_each(V value, double* array, const int* place) {
  store(value, array + place[0]);
}
#else
inline constexpr int kHalf = kWidth / 2;
using Half = hn::Half<D>;

// Exchanges odd neighbours of a with even ones of b, and the same for 16-byte blocks. Each is its own
// inverse.
HWY_INLINE void exchange_neighbours(V& a, V& b) {
  const V low = hn::InterleaveLower(D(), a, b), high = hn::InterleaveUpper(D(), a, b);
  a = low;
  b = high;
}
HWY_INLINE void exchange_blocks(V& a, V& b) {
  const V even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
  const V odd = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
  a = even;
  b = odd;
}
// Transposes one half of the columns of all rows.
HWY_INLINE void transpose_half([[maybe_unused]] V* t) {
  if constexpr (kWidth >= 4) {
    for (int n = 0; n < kHalf; n += 2) exchange_neighbours(t[n], t[n + 1]);
  }
  if constexpr (kWidth == 8) {
    exchange_blocks(t[0], t[2]);
    exchange_blocks(t[1], t[3]);
  }
}
HWY_INLINE void load_block(const double* array, const int* place, V* t) {
  for (int half = 0; half < 2; ++half) {
    for (int l = 0; l < kHalf; ++l)
      t[half * kHalf + l] = hn::Combine(D(), hn::LoadU(Half(), array + place[l + kHalf] + half * kHalf),
                                        hn::LoadU(Half(), array + place[l] + half * kHalf));
    transpose_half(t + half * kHalf);
  }
}
HWY_INLINE void store_block(V* t, double* array, const int* place) {
  for (int half = 0; half < 2; ++half) {
    transpose_half(t + half * kHalf);
    for (int l = 0; l < kHalf; ++l) {
      const V both = t[half * kHalf + l];
      hn::StoreU(hn::LowerHalf(Half(), both), Half(), array + place[l] + half * kHalf);
      hn::StoreU(hn::UpperHalf(Half(), both), Half(), array + place[l + kHalf] + half * kHalf);
    }
  }
}

// Loads one number per lane, each from an address of its own, by combining pairs; stores likewise.
template <int kCount>
HWY_INLINE auto load_each(const double* array, const int* place) {
  const hn::CappedTag<double, kCount> d;
  if constexpr (kCount == 1)
    return hn::LoadU(d, array + *place);
  else
    return hn::Combine(d, load_each<kCount / 2>(array, place + kCount / 2),
                       load_each<kCount / 2>(array, place));
}
template <int kCount, class Values>
HWY_INLINE void store_each(const Values values, double* array, const int* place) {
  if constexpr (kCount == 1) {
    hn::StoreU(values, hn::CappedTag<double, 1>(), array + *place);
  } else {
    const hn::CappedTag<double, kCount / 2> half;
    store_each<kCount / 2>(hn::LowerHalf(half, values), array, place);
    store_each<kCount / 2>(hn::UpperHalf(half, values), array, place + kCount / 2);
  }
}
#endif

// Returns how many columns of clusters with contiguous atoms are transposed in blocks. The last block
// overlaps the one before it, unless so few columns remain that loading them one by one is cheaper.
HWY_INLINE constexpr int columns_by_blocks(int width) {
  const int over = width % kWidth;
  return over <= 2 || width < kWidth ? width - over : width;
}

// Copies `atoms` atoms of the clusters, from atom `first` on, from a 3 × n array into their rows.
HWY_INLINE void gather(const Part& part, const int first, const int atoms, const double* HWY_RESTRICT array,
                       double* HWY_RESTRICT rows) {
  const int width = 3 * atoms;
  const int* place = part.places() + (part.batch.contiguous ? 0 : first * kLanes);
  if (part.batch.contiguous) array += 3 * first;
  rows += 3 * first * kLanes;
  if (!part.batch.contiguous) {
    for (int a = 0; a < atoms; ++a)
      for (int c = 0; c < 3; ++c)
        store(load_each<kWidth>(array + c, place + a * kLanes), rows + (3 * a + c) * kLanes);
    return;
  }
  for (int from = 0; from < columns_by_blocks(width); from += kWidth) {
    const int column = HWY_MIN(from, width - kWidth);
    V t[kWidth];
    load_block(array + column, place, t);
    for (int c = 0; c < kWidth; ++c) store(t[c], rows + (column + c) * kLanes);
  }
  for (int c = columns_by_blocks(width); c < width; ++c)
    store(load_each<kWidth>(array + c, place), rows + c * kLanes);
}

HWY_INLINE void gather(const Part& part, const int atoms, const double* HWY_RESTRICT array,
                       double* HWY_RESTRICT rows) {
  gather(part, 0, atoms, array, rows);
}

// rows ← the sum of two such arrays; `other` may be null, and `scratch` is as large as `rows`.
HWY_INLINE void gather_sum(const Part& part, const int atoms, const double* array, const double* other,
                           double* scratch, double* HWY_RESTRICT rows) {
  gather(part, atoms, array, rows);
  if (!other) return;
  gather(part, atoms, other, scratch);
  for (int c = 0; c < 3 * atoms; ++c)
    store(load(rows + c * kLanes) + load(scratch + c * kLanes), rows + c * kLanes);
}

// Copies `atoms` atoms from atom `first` on back into the array.
HWY_INLINE void scatter(const Part& part, const int first, const int atoms, const double* HWY_RESTRICT rows,
                        double* HWY_RESTRICT array) {
  const int width = 3 * atoms;
  const int* place = part.places() + (part.batch.contiguous ? 0 : first * kLanes);
  if (part.batch.contiguous) array += 3 * first;
  rows += 3 * first * kLanes;
  if (!part.batch.contiguous) {
    for (int a = 0; a < atoms; ++a)
      for (int c = 0; c < 3; ++c)
        store_each<kWidth>(load(rows + (3 * a + c) * kLanes), array + c, place + a * kLanes);
    return;
  }
  for (int from = 0; from < columns_by_blocks(width); from += kWidth) {
    const int column = HWY_MIN(from, width - kWidth);
    V t[kWidth];
    for (int c = 0; c < kWidth; ++c) t[c] = load(rows + (column + c) * kLanes);
    store_block(t, array + column, place);
  }
  for (int c = columns_by_blocks(width); c < width; ++c)
    store_each<kWidth>(load(rows + c * kLanes), array + c, place);
}

// The loop bounds and the addresses of rows for a cluster of any shape.
struct AnyShape {
  explicit AnyShape(const LaneBatch& batch)
      : bonds(batch.bonds.data()),
        row_(batch.plan.row.data()),
        update_(batch.plan.update.data()),
        signed_inv_mass_(batch.plan.signed_inv_mass.data()),
        start_(batch.plan.column_start.data()),
        size_(batch.bond_count()),
        eliminated_(batch.plan.eliminated),
        solved_(batch.plan.solved),
        atoms_(batch.atoms),
        entries_(batch.plan.entries()) {}

  static constexpr bool kUpdates = true;  // eliminating one bond changes the couplings of others
  static constexpr bool kPieces = true;   // the cluster may be a piece of a chain
  const LaneBond* bonds;

  int size() const { return size_; }
  int eliminated() const { return eliminated_; }
  int solved() const { return solved_; }
  int atoms() const { return atoms_; }
  int entries() const { return entries_; }
  std::ptrdiff_t i(int k) const { return bonds[k].i; }
  std::ptrdiff_t j(int k) const { return bonds[k].j; }
  int begin(int k) const { return start_[k]; }  // first entry of column k
  int end(int k) const { return start_[k + 1]; }
  std::ptrdiff_t row(int p) const { return row_[p]; }
  std::ptrdiff_t update(int n) const { return update_[n]; }
  double signed_inv_mass(int p) const { return signed_inv_mass_[p]; }

 protected:
  const std::ptrdiff_t *row_, *update_;
  const double* signed_inv_mass_;
  const int* start_;
  int size_, eliminated_, solved_, atoms_, entries_;
};

// A chain: one entry per column.
struct ChainShape : AnyShape {
  using AnyShape::AnyShape;
  static constexpr bool kUpdates = false, kPieces = false;
  int eliminated() const { return size_; }
  int solved() const { return size_; }
  int begin(int k) const { return k; }
  int end(int k) const { return HWY_MIN(k + 1, size_ - 1); }
};

// A water: all bounds are compile-time constants, so that its rows stay in registers.
struct TriangleShape : AnyShape {
  using AnyShape::AnyShape;
  static constexpr bool kPieces = false;
  static constexpr int size() { return 3; }
  static constexpr int eliminated() { return 3; }
  static constexpr int solved() { return 3; }
  static constexpr int atoms() { return 3; }
  static constexpr int entries() { return 3; }
  static constexpr std::ptrdiff_t i(int k) { return k == 2 ? 3 * kLanes : 0; }
  static constexpr std::ptrdiff_t j(int k) { return k == 0 ? 3 * kLanes : 6 * kLanes; }
  static constexpr int begin(int k) { return k == 0 ? 0 : k + 1; }
  static constexpr int end(int k) { return k == 0 ? 2 : 3; }
  static constexpr std::ptrdiff_t row(int p) { return (p == 0 ? 1 : 2) * kLanes; }
  static constexpr std::ptrdiff_t update(int) { return 2 * kLanes; }
};

// Calls work(shape, part, scratch) for every part of the groups begin … end − 1.
template <class Work>
HWY_INLINE void for_each_part(const LaneBatch& batch, int begin, int end, const Scratch& scratch,
                              const Work& work) {
  const auto each = [&](const auto shape, const Scratch& rows) HWY_ATTR {
    for (int g = begin; g < end; ++g)
      for (int l = 0; l < batch.filled(g); l += kWidth) work(shape, Part{batch, g, l}, rows);
  };
  constexpr int kFew = scratch_rows(3, 3, 3) * kLanes;
  HWY_ALIGN double few[kFew];
  if (batch.triangle)
    each(TriangleShape(batch), Scratch{few, few + kFew});
  else if (batch.chain)
    each(ChainShape(batch), scratch);
  else
    each(AnyShape(batch), scratch);
}

// Copies the rows of the cluster's own atoms back into the array; a piece leaves out its neighbours' atoms.
template <class Shape>
HWY_INLINE void scatter(const Shape shape, const Part& part, const double* rows, double* array) {
  scatter(part, part.batch.left, shape.atoms() - part.batch.left - part.batch.right, rows, array);
}

// f += Jᵀλ for one bond
template <class Shape>
HWY_INLINE void add_constraint_force(const Shape shape, int k, V lambda, const V3& r, double* f) {
  const V3 force = lambda * r;
  double *f_i = f + shape.i(k), *f_j = f + shape.j(k);
  store3(load3(f_i) - force, f_i);
  store3(load3(f_j) + force, f_j);
}

// rows ← f + Jᵀλ of a cluster's own atoms, after a solve that added a thermostat's noise to f. What a piece's neighbours
// write there by now is not read: their rows are left as they are.
template <class Shape>
HWY_NOINLINE void forces_without_noise(const Shape shape, const Part& part, const double* f,
                                       const double* lambda, const double* r, double* rows) {
  gather(part, part.batch.left, shape.atoms() - part.batch.left - part.batch.right, f, rows);
  for (int k = 0; k < shape.size(); ++k)
    add_constraint_force(shape, k, load(lambda + k * kLanes), load3(r + 3 * k * kLanes), rows);
}

// y += M⁻¹Jᵀλ for one bond
template <class Shape>
HWY_INLINE void add_constraint_acceleration(const Shape shape, int k, V lambda, const V3& r, double* y) {
  const V3 force = lambda * r;
  double *y_i = y + shape.i(k), *y_j = y + shape.j(k);
  store3(load3(y_i) - shape.bonds[k].inv_mass_i * force, y_i);
  store3(load3(y_j) + shape.bonds[k].inv_mass_j * force, y_j);
}

// |r|² − d²
HWY_INLINE V twice_sigma(const LaneBond& bond, const V3& r) {
  return dot(r, r) - bond.length2;
}

// x_j − x_i
template <class Shape>
HWY_INLINE V3 difference(const Shape shape, int k, const double* x) {
  return load3(x + shape.j(k)) - load3(x + shape.i(k));
}

// The largest |σ|/d² of a part. The sum is NaN if any of them is.
struct Worst {
  V largest, sum;

  HWY_INLINE Worst() : largest(hn::Zero(D())), sum(hn::Zero(D())) {}
  HWY_INLINE void include(V relative) {
    largest = hn::Max(largest, relative);
    sum += relative;
  }
  HWY_INLINE V include(const LaneBond& bond, V twice_sigma) {
    const V relative = hn::Abs(twice_sigma) * bond.half_inv_length2;
    include(relative);
    return relative;
  }
  // True if all residuals are at most `limit`; false for NaN.
  HWY_INLINE bool within(double limit) const {
    return hn::AllTrue(D(), hn::And(largest <= limit, sum == sum));
  }
};

// Computes |σ|/d² of every bond from positions. Returns the largest.
inline HWY_NOINLINE Worst find_residuals(const LaneBatch& batch, const double* x, double* relative) {
  Worst worst;
  for (int k = 0; k < batch.plan.solved; ++k) {
    const LaneBond& bond = batch.bonds[k];
    const V3 r = load3(x + bond.j) - load3(x + bond.i);
    store(worst.include(bond, twice_sigma(bond, r)), relative + k * kLanes);
  }
  return worst;
}

// Records the largest residual and its bond in the stats if it exceeds the one there. A NaN counts as the
// largest.
inline HWY_NOINLINE void record_largest(const Part& part, const double* relative, SolveStats& stats) {
  for (int k = 0; k < part.batch.plan.solved; ++k)
    for (int l = 0; l < kWidth; ++l) {
      const double value = relative[k * kLanes + l];
      if (!exceeds(value, stats.max_residual)) continue;
      stats.max_residual = value;
      stats.worst_bond = part.batch.bond(part.group, k, part.first_lane + l);
    }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
