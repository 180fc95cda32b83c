// The transforms in one precision, TAUT_FOURIER_REAL: included once by the source file of each.
#include <algorithm>

#include "forcefield/pme/fourier_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/fourier_kernels-inl.hpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Real = TAUT_FOURIER_REAL;
using D = hn::CappedTag<Real, kLanes>;
using V = hn::Vec<D>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(D()));  // lanes worked on at once

struct Complex {
  V re, im;
};
HWY_INLINE Complex operator+(const Complex& a, const Complex& b) {
  return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE Complex operator-(const Complex& a, const Complex& b) {
  return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
HWY_INLINE Complex less_i_times(const Complex& a, const Complex& b) {  // a − ib
  return {hn::Add(a.re, b.im), hn::Sub(a.im, b.re)};
}
HWY_INLINE Complex plus_i_times(const Complex& a, const Complex& b) {  // a + ib
  return {hn::Sub(a.re, b.im), hn::Add(a.im, b.re)};
}
HWY_INLINE Complex turned(const Complex& a, const Real* root) {
  const V c = hn::Set(D(), root[0]), s = hn::Set(D(), root[1]);
  return {hn::NegMulAdd(a.im, s, hn::Mul(a.re, c)), hn::MulAdd(a.im, c, hn::Mul(a.re, s))};
}
HWY_INLINE Complex number(const Columns<Real>& z, std::ptrdiff_t k) {
  return {hn::LoadU(D(), z.re + k * z.apart), hn::LoadU(D(), z.im + k * z.apart)};
}
HWY_INLINE void put(const Complex& a, const Columns<Real>& z, std::ptrdiff_t k) {
  hn::StoreU(a.re, D(), z.re + k * z.apart);
  hn::StoreU(a.im, D(), z.im + k * z.apart);
}

// z(k) ← Σ z(j) e^(−2πijk/radix). Of odd radices the pairs j and radix − j together: their sums take the
// cosines, their differences the sines.
template <int radix>
HWY_INLINE void butterfly(Complex* z, const Real* roots) {
  if constexpr (radix == 2) {
    const Complex sum = z[0] + z[1];
    z[1] = z[0] - z[1];
    z[0] = sum;
  } else if constexpr (radix == 4) {
    const Complex even = z[0] + z[2], odd = z[1] + z[3], apart = z[0] - z[2], aside = z[1] - z[3];
    z[0] = even + odd;
    z[1] = less_i_times(apart, aside);
    z[2] = even - odd;
    z[3] = plus_i_times(apart, aside);
  } else {
    constexpr int kHalf = radix / 2;
    Complex sum[kHalf], difference[kHalf], even[kHalf], odd[kHalf];
#pragma GCC unroll 8
    for (int j = 0; j < kHalf; ++j) {
      sum[j] = z[j + 1] + z[radix - 1 - j];
      difference[j] = z[j + 1] - z[radix - 1 - j];
    }
#pragma GCC unroll 8
    for (int k = 0; k < kHalf; ++k) {
      even[k] = z[0];
      odd[k] = {hn::Zero(D()), hn::Zero(D())};
#pragma GCC unroll 8
      for (int j = 0; j < kHalf; ++j) {
        const Real* root = roots + 2 * ((j + 1) * (k + 1) % radix);
        const V c = hn::Set(D(), root[0]), s = hn::Set(D(), -root[1]);
        even[k] = {hn::MulAdd(c, sum[j].re, even[k].re), hn::MulAdd(c, sum[j].im, even[k].im)};
        odd[k] = {hn::MulAdd(s, difference[j].re, odd[k].re), hn::MulAdd(s, difference[j].im, odd[k].im)};
      }
    }
#pragma GCC unroll 8
    for (int j = 0; j < kHalf; ++j) z[0] = z[0] + sum[j];
#pragma GCC unroll 8
    for (int k = 0; k < kHalf; ++k) {
      z[k + 1] = less_i_times(even[k], odd[k]);
      z[radix - 1 - k] = plus_i_times(even[k], odd[k]);
    }
  }
}

template <int radix>
HWY_INLINE void pass(const FourierPlan<Real>::Pass& how, const Real* roots, const Columns<Real>& from,
                     const Columns<Real>& to) {
  const std::ptrdiff_t s = how.together, apart = s * how.groups;
  const auto group = [&](int p, auto turns) HWY_ATTR {
    const Real* root = roots + 2 * (radix + p * (radix - 1));
    for (std::ptrdiff_t q = 0; q < s; ++q) {
      Complex z[radix];
#pragma GCC unroll 8
      for (int j = 0; j < radix; ++j) z[j] = number(from, q + s * p + apart * j);
      butterfly<radix>(z, roots);
      put(z[0], to, q + s * radix * p);
#pragma GCC unroll 8
      for (int k = 1; k < radix; ++k) {
        if constexpr (turns) z[k] = turned(z[k], root + 2 * (k - 1));
        put(z[k], to, q + s * (radix * p + k));
      }
    }
  };
  group(0, std::false_type());  // its roots are one
  for (int p = 1; p < how.groups; ++p) group(p, std::true_type());
}

// Of any radix, by the sum as it stands. A radix of one copies.
HWY_INLINE void pass_of_any(const FourierPlan<Real>::Pass& how, const Real* roots, const Columns<Real>& from,
                            const Columns<Real>& to) {
  const std::ptrdiff_t s = how.together, apart = s * how.groups, radix = how.radix;
  for (int p = 0; p < how.groups; ++p)
    for (std::ptrdiff_t q = 0; q < s; ++q)
      for (std::ptrdiff_t k = 0; k < radix; ++k) {
        Complex sum = number(from, q + s * p);
        for (std::ptrdiff_t j = 1; j < radix; ++j)
          sum = sum + turned(number(from, q + s * p + apart * j), roots + 2 * (j * k % radix));
        put(k == 0 ? sum : turned(sum, roots + 2 * (radix + p * (radix - 1) + k - 1)), to,
            q + s * (radix * p + k));
      }
}

void transform_all(const FourierPlan<Real>& plan, const Columns<Real>& from, const Columns<Real>& to,
                   Real* room) {
  const std::size_t n = std::size_t(kLanes) * plan.size;
  const Columns<Real> on_the_way[] = {{room, room + n, kLanes}, {room + 2 * n, room + 3 * n, kLanes}};
  const auto lanes_from = [](const Columns<Real>& z, int lane) {
    return Columns<Real>{z.re + lane, z.im + lane, z.apart};
  };
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    Columns<Real> now = lanes_from(from, lane);
    for (std::size_t k = 0; k < plan.passes.size(); ++k) {
      const auto& how = plan.passes[k];
      const Columns<Real> next = lanes_from(k + 1 == plan.passes.size() ? to : on_the_way[k % 2], lane);
      const Real* roots = plan.roots.data() + how.roots;
      switch (how.radix) {
        case 2:
          pass<2>(how, roots, now, next);
          break;
        case 3:
          pass<3>(how, roots, now, next);
          break;
        case 4:
          pass<4>(how, roots, now, next);
          break;
        case 5:
          pass<5>(how, roots, now, next);
          break;
        case 7:
          pass<7>(how, roots, now, next);
          break;
        default:
          pass_of_any(how, roots, now, next);
      }
      now = next;
    }
  }
}

// a = (Z(k) + Z*(−k))/2, b = (Z(k) − Z*(−k))/2i
void part(int size, const Columns<Real>& both, const Columns<Real>& parts) {
  const V half = hn::Set(D(), Real(0.5));
  for (int lane = 0; lane < kLanes; lane += kWidth)
    for (int k = 0; k <= size / 2; ++k) {
      const Columns<Real> z{both.re + lane, both.im + lane, both.apart};
      const Complex up = number(z, k), down = number(z, k == 0 ? 0 : size - k);
      const Complex sum = up + down, difference = up - down;
      const Columns<Real> a{parts.re + lane, parts.im + lane, parts.apart},
          b{a.re + kLanes, a.im + kLanes, a.apart};
      put({hn::Mul(half, sum.re), hn::Mul(half, difference.im)}, a, k);
      put({hn::Mul(half, sum.im), hn::Neg(hn::Mul(half, difference.re))}, b, k);
    }
}

void join(int size, const Columns<Real>& parts, const Columns<Real>& both) {
  for (int lane = 0; lane < kLanes; lane += kWidth)
    for (int k = 0; k <= size / 2; ++k) {
      const Columns<Real> z{both.re + lane, both.im + lane, both.apart};
      const Columns<Real> at{parts.re + lane, parts.im + lane, parts.apart};
      Complex a = number(at, k), b = number({at.re + kLanes, at.im + kLanes, at.apart}, k);
      if (k == 0 || 2 * k == size) a.im = b.im = hn::Zero(D());  // or what is left of a's would be b's
      put({hn::Sub(a.re, b.im), hn::Add(a.im, b.re)}, z, k);
      if (k > 0) put({hn::Add(a.re, b.im), hn::Sub(b.re, a.im)}, z, size - k);
    }
}

// Four and four rows interleave, then both fours.
void turn(int size, const Real* rows, std::ptrdiff_t apart, Real* columns) {
  HWY_ALIGN Real fours[2][4 * kWidth];
  for (int k = 0; k < size; k += kWidth, rows += kWidth, columns += kWidth * kLanes) {
    for (int odd = 0; odd < 2; ++odd) {
      const auto row = [&](int r) HWY_ATTR { return hn::LoadU(D(), rows + (2 * r + odd) * apart); };
      hn::StoreInterleaved4(row(0), row(1), row(2), row(3), D(), fours[odd]);
    }
    for (int v = 0; v < 4; ++v)
      hn::StoreInterleaved2(hn::Load(D(), fours[0] + v * kWidth), hn::Load(D(), fours[1] + v * kWidth), D(),
                            columns + 2 * v * kWidth);
  }
}

void turn_back(int size, const Real* columns, Real* rows, std::ptrdiff_t apart) {
  HWY_ALIGN Real fours[2][4 * kWidth];
  for (int k = 0; k < size; k += kWidth, rows += kWidth, columns += kWidth * kLanes) {
    V a, b, c, d;
    for (int v = 0; v < 4; ++v) {
      hn::LoadInterleaved2(D(), columns + 2 * v * kWidth, a, b);
      hn::Store(a, D(), fours[0] + v * kWidth);
      hn::Store(b, D(), fours[1] + v * kWidth);
    }
    for (int odd = 0; odd < 2; ++odd) {
      hn::LoadInterleaved4(D(), fours[odd], a, b, c, d);
      const auto put_row = [&](V value, int r)
                               HWY_ATTR { hn::StoreU(value, D(), rows + (2 * r + odd) * apart); };
      put_row(a, 0);
      put_row(b, 1);
      put_row(c, 2);
      put_row(d, 3);
    }
  }
}

double filter_all(int size, const Real* factor, const Columns<Real>& z) {
  double sum[kLanes] = {};
  Real *re = z.re, *im = z.im;
  for (int k = 0; k < size; ++k, factor += kLanes, re += z.apart, im += z.apart)
    for (int lane = 0; lane < kLanes; ++lane) {
      const Real g = factor[lane], r = re[lane], i = im[lane];
      sum[lane] += double(g * (r * r + i * i));
      re[lane] = g * r;
      im[lane] = g * i;
    }
  double all = 0;
  for (const double s : sum) all += s;
  return all;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

using Real = TAUT_FOURIER_REAL;

HWY_EXPORT(transform_all);
HWY_EXPORT(part);
HWY_EXPORT(join);
HWY_EXPORT(turn);
HWY_EXPORT(turn_back);
HWY_EXPORT(filter_all);

template <>
void transform(const FourierPlan<Real>& plan, const Columns<Real>& from, const Columns<Real>& to,
               Real* room) {
  HWY_DYNAMIC_DISPATCH(transform_all)(plan, from, to, room);
}
template <>
void part_real(int size, const Columns<Real>& both, const Columns<Real>& parts) {
  HWY_DYNAMIC_DISPATCH(part)(size, both, parts);
}
template <>
void join_real(int size, const Columns<Real>& parts, const Columns<Real>& both) {
  HWY_DYNAMIC_DISPATCH(join)(size, parts, both);
}
template <>
void rows_to_columns(int size, const Real* rows, std::ptrdiff_t apart, Real* columns) {
  HWY_DYNAMIC_DISPATCH(turn)(size, rows, apart, columns);
}
template <>
void columns_to_rows(int size, const Real* columns, Real* rows, std::ptrdiff_t apart) {
  HWY_DYNAMIC_DISPATCH(turn_back)(size, columns, rows, apart);
}
template <>
double filter(int size, const Real* factor, const Columns<Real>& z) {
  return HWY_DYNAMIC_DISPATCH(filter_all)(size, factor, z);
}

}  // namespace taut
#endif
