#include "ensembles/noise.hpp"

#include <cmath>

#include "base/random.hpp"
#include "base/shares.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ensembles/noise.cpp"
#include <hwy/foreach_target.h>

#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using Bits = hn::RebindToUnsigned<D>;
using W = hn::Vec<Bits>;  // words of 32 bits, one in each lane of 64; the upper half may hold anything

// 64 bits of the product of two words.
HWY_INLINE W product(W a, std::uint32_t b) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(Bits(), (hn::GetLane(a) & 0xFFFFFFFF) * b);
#else
  const hn::Repartition<std::uint32_t, D> words;
  return hn::BitCast(Bits(), hn::MulEven(hn::BitCast(words, a), hn::Set(words, b)));
#endif
}

// philox() of base/random.hpp, in lanes.
HWY_INLINE void scramble(W (&counter)[4], std::uint32_t key0, std::uint32_t key1) {
  for (int round = 0; round < 10; ++round) {
    const W a = product(counter[0], 0xD2511F53), b = product(counter[2], 0xCD9E8D57);
    counter[0] = hn::Xor(hn::Xor(hn::ShiftRight<32>(b), counter[1]), hn::Set(Bits(), key0));
    counter[2] = hn::Xor(hn::Xor(hn::ShiftRight<32>(a), counter[3]), hn::Set(Bits(), key1));
    counter[1] = b;
    counter[3] = a;
    key0 += 0x9E3779B9, key1 += 0xBB67AE85;
  }
}

// The number n < 2⁵² that 64 bits hold: 2⁵² + n has n in its lowest bits.
HWY_INLINE V as_double(W n) {
  return hn::BitCast(D(), hn::Or(n, hn::Set(Bits(), 0x4330000000000000))) - 0x1p52;
}

// No product and sum below may be fused (CMakeLists.txt sees to it), or machines would differ by a last bit.
template <int kTerms>
HWY_INLINE V polynomial(V x, const double (&coefficient)[kTerms]) {
  V sum = hn::Set(D(), coefficient[kTerms - 1]);
  for (int n = kTerms - 2; n >= 0; --n) sum = sum * x + coefficient[n];
  return sum;
}

// −ln u, u = (2w + 1)/2³³ of a word w. With 2w + 1 = 2ᵉm, √½ ≤ m < √2, and s = (m − 1)/(m + 1) it is
//     (33 − e) ln 2 − 2s(1 + s²/3 + s⁴/5 + …),   s² < 0.03.
HWY_INLINE V minus_log(W word) {
  constexpr double kOdd[] = {1, 1. / 3, 1. / 5, 1. / 7, 1. / 9, 1. / 11, 1. / 13, 1. / 15, 1. / 17};
  const W root_half = hn::BitCast(Bits(), hn::Set(D(), 0.70710678118654752));
  const W odd = hn::Or(hn::ShiftLeft<1>(word), hn::Set(Bits(), 1));
  const W bits = hn::BitCast(Bits(), as_double(odd));
  const W e = hn::ShiftRight<52>(bits - root_half);
  const V m = hn::BitCast(D(), bits - hn::ShiftLeft<52>(e));
  const V s = (m - 1) / (m + 1);
  const V log_m = (s + s) * polynomial(s * s, kOdd);
  return (33 - as_double(e)) * 0.69314718055994531 - log_m;
}

// √(−2 ln u) cos t and √(−2 ln u) sin t. With t = τ + π/4, |τ| < π/4, they are √(−ln u) (cos τ ∓ sin τ).
HWY_INLINE void box_muller(W radius, W angle, V& first, V& second) {
  constexpr double kSine[] = {1, -1. / 6, 1. / 120, -1. / 5040, 1. / 362880, -1. / 39916800, 1. / 6227020800};
  constexpr double kCosine[] = {1,          -1. / 2,       1. / 24,         -1. / 720,
                                1. / 40320, -1. / 3628800, 1. / 479001600., -1. / 87178291200.};
  constexpr double kQuarter = 0.78539816339744831;  // π/4
  const W sign = hn::Set(Bits(), std::uint64_t{1} << 63);
  const V r = hn::Sqrt(minus_log(radius));
  const V n = as_double(hn::And(angle, hn::Set(Bits(), 0x3FFFFFFF)));  // 30 bits; t = (n + ½) 2⁻³⁰ π/2
  const V tau = (n - (0x1p29 - 0.5)) * (kQuarter * 0x1p-29);
  const V square = tau * tau;
  const V sine = tau * polynomial(square, kSine), cosine = polynomial(square, kCosine);
  const V s1 = hn::BitCast(D(), hn::And(hn::ShiftLeft<32>(angle), sign));
  const V s2 = hn::BitCast(D(), hn::And(hn::ShiftLeft<33>(angle), sign));
  first = hn::Xor(r * (cosine - sine), s1);
  second = hn::Xor(r * (cosine + sine), s2);
}

// The numbers from 4·begin to 4·end; both are multiples of the lanes.
void fill(std::uint64_t seed, std::uint64_t step, std::size_t begin, std::size_t end, double* noise) {
  const W low = hn::Set(Bits(), 0xFFFFFFFF);
  for (std::size_t n = begin; n < end; n += hn::Lanes(D())) {
    W words[] = {hn::Iota(Bits(), n), hn::Set(Bits(), static_cast<std::uint64_t>(Stream::kLangevin)),
                 hn::Set(Bits(), step & 0xFFFFFFFF), hn::Set(Bits(), step >> 32)};
    scramble(words, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
    for (W& word : words) word = hn::And(word, low);
    V r[4];
    box_muller(words[0], words[1], r[0], r[1]);
    box_muller(words[2], words[3], r[2], r[3]);
    hn::StoreInterleaved4(r[0], r[1], r[2], r[3], D(), noise + 4 * n);
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(fill);

void fill_with_noise(std::uint64_t seed, std::uint64_t step, Aligned<double>& noise) {
  const auto blocks = static_cast<int>(noise.size() / kNoiseBlock);
  in_shares(blocks, kAtomsOfShortWork * 3 / kNoiseBlock, [&](const Share& share) {
    constexpr std::size_t kCounters = kNoiseBlock / 4;
    HWY_DYNAMIC_DISPATCH(fill)(seed, step, kCounters * share.begin, kCounters * share.end, noise.data());
  });
}

}  // namespace taut
#endif
