// The transforms in one precision, TAUT_FOURIER_REAL: included once by the source file of each.
#include <algorithm>
#include <utility>

#include "forcefield/ewald/fourier_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/ewald/fourier_kernels-inl.hpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

using Real = TAUT_FOURIER_REAL;

// In an unnamed namespace, because types and templates of both precisions have the same names.
namespace {

using D = hn::ScalableTag<Real>;
using V = hn::Vec<D>;
using Stage = FourierPlan<Real>::Stage;

// A complex number of each lane's sequence.
struct Z {
  V re, im;
};
HWY_INLINE Z operator+(const Z& a, const Z& b) {
  return {a.re + b.re, a.im + b.im};
}
HWY_INLINE Z operator-(const Z& a, const Z& b) {
  return {a.re - b.re, a.im - b.im};
}
HWY_INLINE Z plus_i(const Z& a, const Z& b) {  // a + ib
  return {a.re - b.im, a.im + b.re};
}
HWY_INLINE Z minus_i(const Z& a, const Z& b) {
  return {a.re + b.im, a.im - b.re};
}
HWY_INLINE Z times(const std::complex<Real>& w, const Z& a) {
  const V re = hn::Set(D(), w.real()), im = hn::Set(D(), w.imag());
  return {hn::MulSub(re, a.re, im * a.im), im * a.re + re * a.im};
}
HWY_INLINE Z add_times(Real w, const Z& a, const Z& to) {
  return {to.re + w * a.re, to.im + w * a.im};
}

// Where a stage finds and leaves the numbers of the lanes' sequences: real parts and imaginary parts side by side …
struct Scratch {
  Real* first;
  HWY_INLINE Z load(std::ptrdiff_t k) const {
    const D d;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    return {hn::Load(d, first + 2 * k * lanes), hn::Load(d, first + (2 * k + 1) * lanes)};
  }
  HWY_INLINE void store(std::ptrdiff_t k, const Z& z) const {
    const D d;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    hn::Store(z.re, d, first + 2 * k * lanes);
    hn::Store(z.im, d, first + (2 * k + 1) * lanes);
  }
};
// … or as complex numbers, of neighbouring sequences side by side. A transform backward is the one forward with real and
// imaginary parts exchanged before and after.
template <Direction direction>
struct Memory {
  Real* first;
  std::ptrdiff_t along;  // in real numbers
  HWY_INLINE Z load(std::ptrdiff_t k) const {
    Z z;
    hn::LoadInterleaved2(D(), first + k * along, direction == Direction::kForward ? z.re : z.im,
                         direction == Direction::kForward ? z.im : z.re);
    return z;
  }
  HWY_INLINE void store(std::ptrdiff_t k, const Z& z) const {
    hn::StoreInterleaved2(direction == Direction::kForward ? z.re : z.im,
                          direction == Direction::kForward ? z.im : z.re, D(), first + k * along);
  }
};

// Calls put(j, Σₖ aₖ e^(−2πijk/r)) for each j; e^(−2πik/r) is roots[k].
template <int r>
struct Butterfly;
template <>
struct Butterfly<2> {
  HWY_INLINE static void run(const auto&, const auto& a, const auto& put) {
    const Z a0 = a(0), a1 = a(1);
    put(0, a0 + a1);
    put(1, a0 - a1);
  }
};
template <>
struct Butterfly<4> {
  HWY_INLINE static void run(const auto&, const auto& a, const auto& put) {
    const Z a0 = a(0), a1 = a(1), a2 = a(2), a3 = a(3);
    const Z even = a0 + a2, odd = a1 + a3, even_less = a0 - a2, odd_less = a1 - a3;
    put(0, even + odd);
    put(1, minus_i(even_less, odd_less));
    put(2, even - odd);
    put(3, plus_i(even_less, odd_less));
  }
};
// An odd one: waves j and r − j share the sums of aₖ ± aᵣ₋ₖ with cosines and sines.
template <int r>
struct Butterfly {
  HWY_INLINE static void run(const auto& roots, const auto& a, const auto& put) {
    constexpr int kHalf = r / 2;
    const Z a0 = a(0);
    Z sum[kHalf], less[kHalf], all = a0;
#pragma GCC unroll 3
    for (int k = 1; k <= kHalf; ++k) {
      const Z up = a(k), down = a(r - k);
      sum[k - 1] = up + down;
      less[k - 1] = up - down;
      all = all + sum[k - 1];
    }
    put(0, all);
#pragma GCC unroll 3
    for (int j = 1; j <= kHalf; ++j) {
      const V zero = hn::Zero(D());
      Z even = a0, odd{zero, zero};
#pragma GCC unroll 3
      for (int k = 1; k <= kHalf; ++k) {
        even = add_times(roots(j * k % r).real(), sum[k - 1], even);
        odd = add_times(-roots(j * k % r).imag(), less[k - 1], odd);
      }
      put(j, minus_i(even, odd));
      put(r - j, plus_i(even, odd));
    }
  }
};
// Of r = r₁r₂ (Cooley & Tukey 1965, doi:10.1090/S0025-5718-1965-0178586-1): those of r₁, of every r₂-th number, turned,
// then those of r₂.
template <int r1, int r2>
struct TwoButterflies {
  HWY_INLINE static void run(const auto& roots, const auto& a, const auto& put) {
    Z inner[r2][r1];
#pragma GCC unroll 3
    for (int k2 = 0; k2 < r2; ++k2)
      Butterfly<r1>::run(
          [&](int k) HWY_ATTR { return roots(r2 * k); }, [&](int k1) HWY_ATTR { return a(r2 * k1 + k2); },
          [&](int j1, const Z& z) HWY_ATTR { inner[k2][j1] = j1 * k2 == 0 ? z : times(roots(j1 * k2), z); });
#pragma GCC unroll 4
    for (int j1 = 0; j1 < r1; ++j1)
      Butterfly<r2>::run([&](int k) HWY_ATTR { return roots(r1 * k); },
                         [&](int k2) HWY_ATTR { return inner[k2][j1]; },
                         [&](int j2, const Z& z) HWY_ATTR { put(j1 + r1 * j2, z); });
  }
};
template <>
struct Butterfly<6> : TwoButterflies<3, 2> {};
template <>
struct Butterfly<8> : TwoButterflies<4, 2> {};
template <>
struct Butterfly<9> : TwoButterflies<3, 3> {};
HWY_INLINE void butterfly_any(const Stage& stage, const auto& a, const auto& put) {
  for (int j = 0; j < stage.radix; ++j) {
    Z sum = a(0);
    for (int k = 1; k < stage.radix; ++k)
      sum = sum + times(stage.roots[static_cast<std::size_t>(j) * k % stage.radix], a(k));
    put(j, sum);
  }
}

// The stage as it stands in fourier_kernels.hpp, of one p.
template <int r, bool turned>
HWY_INLINE void run_butterflies(const Stage& stage, std::ptrdiff_t s, std::ptrdiff_t p, const auto& from,
                                const auto& to) {
  const std::ptrdiff_t radix = r > 0 ? r : stage.radix, apart = s * stage.rest;
  const std::complex<Real>* const turn = stage.turned.data() + p * (radix - 1) - 1;
  const auto roots = [&](int k) HWY_ATTR { return stage.roots[k]; };
  for (std::ptrdiff_t q = 0; q < s; ++q) {
    const std::ptrdiff_t first = q + s * p, out = q + s * radix * p;
    const auto a = [&](int k) HWY_ATTR { return from.load(first + apart * k); };
    const auto put = [&](int j, const Z& z) __attribute__((always_inline)) HWY_ATTR {
      to.store(out + s * j, turned && j > 0 ? times(turn[j], z) : z);
    };
    if constexpr (r == 0)
      butterfly_any(stage, a, put);
    else
      Butterfly<r>::run(roots, a, put);
  }
}
template <int r>
HWY_INLINE void run_stage_of(const Stage& stage, int s, const auto& from, const auto& to) {
  run_butterflies<r, false>(stage, s, 0, from, to);
  for (int p = 1; p < stage.rest; ++p) run_butterflies<r, true>(stage, s, p, from, to);
}
HWY_NOINLINE void run_stage(const Stage& stage, int s, const auto& from, const auto& to) {
  switch (stage.radix) {
    case 2:
      return run_stage_of<2>(stage, s, from, to);
    case 3:
      return run_stage_of<3>(stage, s, from, to);
    case 4:
      return run_stage_of<4>(stage, s, from, to);
    case 5:
      return run_stage_of<5>(stage, s, from, to);
    case 6:
      return run_stage_of<6>(stage, s, from, to);
    case 7:
      return run_stage_of<7>(stage, s, from, to);
    case 8:
      return run_stage_of<8>(stage, s, from, to);
    case 9:
      return run_stage_of<9>(stage, s, from, to);
    default:
      return run_stage_of<0>(stage, s, from, to);
  }
}

using Numbers = std::complex<Real>*;

// Rows of complex numbers, so far apart.
struct Matrix {
  Numbers first;
  std::ptrdiff_t apart;
};
#if HWY_TARGET != HWY_SCALAR && HWY_MAX_BYTES >= 32
// Transposes four rows and four columns, a complex number of single precision as one number of double.
constexpr int kTransposed = sizeof(Real) == sizeof(float) ? 4 : 1;
HWY_INLINE void transpose_square(const Matrix& from, const Matrix& to) {
  const hn::FixedTag<double, 4> d;
  const auto row = [&](int k) HWY_ATTR {
    return hn::LoadU(d, reinterpret_cast<const double*>(from.first + k * from.apart));
  };
  const auto store = [&](int k, const auto& v)
                         HWY_ATTR { hn::StoreU(v, d, reinterpret_cast<double*>(to.first + k * to.apart)); };
  const auto lower0 = hn::InterleaveLower(d, row(0), row(1)), upper0 = hn::InterleaveUpper(d, row(0), row(1)),
             lower2 = hn::InterleaveLower(d, row(2), row(3)), upper2 = hn::InterleaveUpper(d, row(2), row(3));
  store(0, hn::ConcatLowerLower(d, lower2, lower0));
  store(1, hn::ConcatLowerLower(d, upper2, upper0));
  store(2, hn::ConcatUpperUpper(d, lower2, lower0));
  store(3, hn::ConcatUpperUpper(d, upper2, upper0));
}
#else
constexpr int kTransposed = 1;
HWY_INLINE void transpose_square(const Matrix&, const Matrix&) {}
#endif
void transpose(const Matrix& from, int rows, int columns, const Matrix& to) {
  const auto whole = [](int n) { return kTransposed > 1 ? n / kTransposed * kTransposed : 0; };
  for (int row = 0; row < whole(rows); row += kTransposed)
    for (int column = 0; column < whole(columns); column += kTransposed)
      transpose_square({from.first + row * from.apart + column, from.apart},
                       {to.first + column * to.apart + row, to.apart});
  for (int row = 0; row < rows; ++row)
    for (int column = row < whole(rows) ? whole(columns) : 0; column < columns; ++column)
      to.first[column * to.apart + row] = from.first[row * from.apart + column];
}

// Transforms as many sequences as there are lanes, or fewer. What vectors cannot read or write where it lies goes through
// scratch memory.
template <Direction direction>
void transform_block(const FourierPlan<Real>& plan, const Sequences<Real>& from, const Sequences<Real>& to,
                     int count, Real* scratch) {
  const auto stages = plan.stages();
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(D()));
  const int n = plan.length(), last = static_cast<int>(stages.size()) - 1;
  Real *here = scratch, *there = scratch + 2 * n * lanes;
  const auto in_vectors = [&](const Sequences<Real>& at) {
    return at.layout == Layout::kSideBySide && count == lanes;
  };
  const auto copied = [&] { return Matrix{reinterpret_cast<Numbers>(here), lanes}; };
  const auto place = [&](const Sequences<Real>& at) {
    const Matrix numbers = in_vectors(at) ? Matrix{at.first, at.apart} : copied();
    return Memory<direction>{reinterpret_cast<Real*>(numbers.first), 2 * numbers.apart};
  };
  const auto copy_rows = [&](const Matrix& in, const Matrix& out) {
    for (int k = 0; k < n; ++k) std::copy_n(in.first + k * in.apart, count, out.first + k * out.apart);
  };

  if (from.layout == Layout::kInTurn)
    transpose({from.first, from.apart}, count, n, copied());
  else if (!in_vectors(from))
    copy_rows({from.first, from.apart}, copied());
  run_stage(stages[0], 1, place(from), Scratch{there});
  int s = stages[0].radix;
  for (int k = 1; k < last; s *= stages[k++].radix) {
    std::swap(here, there);
    run_stage(stages[k], s, Scratch{here}, Scratch{there});
  }
  run_stage(stages[last], s, Scratch{there}, place(to));
  if (to.layout == Layout::kInTurn)
    transpose(copied(), n, count, {to.first, to.apart});
  else if (!in_vectors(to))
    copy_rows(copied(), {to.first, to.apart});
}

}  // namespace

// The last block begins early enough to be whole, and writes some of what the one before it wrote again.
void transform_all(const FourierPlan<Real>& plan, Direction direction, const Sequences<Real>& from,
                   const Sequences<Real>& to, int count, Real* scratch) {
  const int together = std::min(static_cast<int>(hn::Lanes(D())), count);
  for (int first = 0; first < count; first += together) {
    const int begin = std::min(first, count - together);
    const auto block = [&](const Sequences<Real>& all) {
      return Sequences<Real>{all.first + begin * (all.layout == Layout::kSideBySide ? 1 : all.apart),
                             all.apart, all.layout};
    };
    if (direction == Direction::kForward)
      transform_block<Direction::kForward>(plan, block(from), block(to), together, scratch);
    else
      transform_block<Direction::kBackward>(plan, block(from), block(to), together, scratch);
  }
}

void separate_row(const std::complex<Real>* up, const std::complex<Real>* down, int count,
                  std::complex<Real>* parts) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int j = 0;
  for (; j + lanes <= count; j += lanes) {
    Z u, v;
    hn::LoadInterleaved2(d, reinterpret_cast<const Real*>(up + j), u.re, u.im);
    hn::LoadInterleaved2(d, reinterpret_cast<const Real*>(down + j), v.re, v.im);
    hn::StoreInterleaved4(0.5 * (u.re + v.re), 0.5 * (u.im - v.im), 0.5 * (u.im + v.im), 0.5 * (v.re - u.re),
                          d, reinterpret_cast<Real*>(parts + 2 * j));
  }
  for (; j < count; ++j) {
    const std::complex<Real> u = up[j], v = std::conj(down[j]), less = v - u;
    parts[2 * j] = Real(0.5) * (u + v);
    parts[2 * j + 1] = Real(0.5) * std::complex<Real>(-less.imag(), less.real());
  }
}
void join_row(const std::complex<Real>* parts, int count, std::complex<Real>* up, std::complex<Real>* down) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int j = 0;
  for (; j + lanes <= count; j += lanes) {
    Z a, b;
    hn::LoadInterleaved4(d, reinterpret_cast<const Real*>(parts + 2 * j), a.re, a.im, b.re, b.im);
    if (up == down) {
      hn::StoreInterleaved2(a.re, b.re, d, reinterpret_cast<Real*>(up + j));
      continue;
    }
    hn::StoreInterleaved2(a.re - b.im, a.im + b.re, d, reinterpret_cast<Real*>(up + j));
    hn::StoreInterleaved2(a.re + b.im, b.re - a.im, d, reinterpret_cast<Real*>(down + j));
  }
  for (; j < count; ++j) {
    const std::complex<Real> a = parts[2 * j], b = parts[2 * j + 1];
    up[j] = {a.real() - b.imag(), a.imag() + b.real()};
    down[j] = up == down ? std::complex<Real>(a.real(), b.real())
                         : std::complex<Real>(a.real() + b.imag(), b.real() - a.imag());
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

using Real = TAUT_FOURIER_REAL;

HWY_EXPORT(transform_all);
HWY_EXPORT(separate_row);
HWY_EXPORT(join_row);
template <>
void transform_sequences(const FourierPlan<Real>& plan, Direction direction, const Sequences<Real>& from,
                         const Sequences<Real>& to, int count, Real* scratch) {
  HWY_DYNAMIC_DISPATCH(transform_all)(plan, direction, from, to, count, scratch);
}
template <>
void separate_pairs(const std::complex<Real>* up, const std::complex<Real>* down, int count,
                    std::complex<Real>* parts) {
  HWY_DYNAMIC_DISPATCH(separate_row)(up, down, count, parts);
}
template <>
void join_pairs(const std::complex<Real>* parts, int count, std::complex<Real>* up,
                std::complex<Real>* down) {
  HWY_DYNAMIC_DISPATCH(join_row)(parts, count, up, down);
}

}  // namespace taut
#endif
