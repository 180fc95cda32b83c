// Ewald's screening in lanes. Included once a target.
#if defined(TAUT_SCREENING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_SCREENING_INL
#undef TAUT_SCREENING_INL
#else
#define TAUT_SCREENING_INL
#endif

#include <vector>

#include "base/lane_arithmetic-inl.hpp"
#include "forcefield/ewald/screening.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// α H or α³ G of vectors of squared distances. On targets with a one-instruction permutation of lanes, one
// vector holds a coefficient of all intervals, and polynomials of many short intervals need fewer terms: 11 instead
// of 22 in double precision, 5 instead of 12 in single. Other targets use one interval.
template <class D>
struct ScreeningIntervals {
  static constexpr std::size_t kLanes = hn::MaxLanes(D()), kNumber = sizeof(hn::TFromD<D>);
  static constexpr bool kMany =
      (HWY_TARGET <= HWY_AVX3 && kLanes * kNumber == 64) || (HWY_TARGET == HWY_AVX2 && kLanes == 8);
  static constexpr int kIntervals = kMany ? int(kLanes) : 1;
  // The terms that usual tolerances need, known when the kernel is compiled. Kernels for tight tolerances
  // (fine) take any number.
  static constexpr int kTerms = kIntervals == 1 ? 2 : kNumber == 8 ? 11 : kIntervals == 16 ? 5 : 7;

  static constexpr ScreeningFit fit() {
    // The fit's error bounds each interval. One interval as wide as the cutoff has that error everywhere; most of
    // many short intervals have far less.
    return {kIntervals, kTerms, kNumber == 4 ? (kMany ? 2e-6 : 2e-8) : (kMany ? 2e-13 : 1e-15)};
  }
  static bool fine(const std::vector<double>& numbers) {
    return kMany && numbers.size() > kIntervals * kTerms;
  }
};

template <class D, bool fine>
class ScreenInLanes {
  using T = hn::TFromD<D>;
  using V = hn::Vec<D>;
  using Intervals = ScreeningIntervals<D>;
  static constexpr int kIntervals = Intervals::kIntervals;

 public:
  // of: Screening's numbers; the result comes times `factor`.
  HWY_INLINE ScreenInLanes(double scale, const std::vector<double>& of, double factor)
      : scale_(static_cast<T>(scale)), terms_(static_cast<int>(of.size()) / kIntervals) {
    for (std::size_t k = 0; k < of.size(); ++k) number_[k] = static_cast<T>(of[k] * factor);
  }
  bool wanted() const { return terms_ > 0; }

  template <int K>
  HWY_INLINE void operator()(const V (&r2)[K], V (&out)[K]) const {
    sum<K>(fine || kIntervals == 1 ? terms_ : Intervals::kTerms, r2, out);
  }

 private:
  using Interval = hn::Vec<hn::RebindToSigned<D>>;

  // Horner's rule for even and odd powers apart: two shorter chains of dependent operations.
  template <int K>
  HWY_INLINE void sum(const int terms, const V (&r2)[K], V (&out)[K]) const {
    V t[K], t2[K], next[K];
    Interval interval[K];
    for (int k = 0; k < K; ++k) {
      t[k] = find_interval(r2[k], interval[k]);
      t2[k] = t[k] * t[k];
      out[k] = coefficient(terms - 1, interval[k]);
      next[k] = coefficient(terms - 2, interval[k]);
    }
    for (int term = terms - 3; term > 0; term -= 2)
      for (int k = 0; k < K; ++k) {
        out[k] = out[k] * t2[k] + coefficient(term, interval[k]);
        next[k] = next[k] * t2[k] + coefficient(term - 1, interval[k]);
      }
    for (int k = 0; k < K; ++k) {
      if (terms % 2 == 0)
        out[k] = out[k] * t[k] + next[k];
      else
        out[k] = coefficient(0, interval[k]) + next[k] * t[k] + out[k] * t2[k];
    }
  }

  // Adding `whole` rounds to an integer, which is then in the low bits. Beyond the cutoff the interval is
  // arbitrary.
  HWY_INLINE V find_interval(V r2, [[maybe_unused]] Interval& interval) const {
    if constexpr (kIntervals == 1) return r2 * scale_ - 0.5;
    constexpr T whole = sizeof(T) == 8 ? T(0x1.8p52) : T(0x1.8p23);
    const V sum = r2 * scale_ + whole;
    interval = hn::BitCast(hn::RebindToSigned<D>(), sum);
    return r2 * scale_ - (sum - whole);
  }

  // The coefficient of each lane's own interval.
  HWY_INLINE V coefficient(int term, [[maybe_unused]] const Interval& interval) const {
    const T* of_intervals = number_ + kIntervals * term;
#if HWY_TARGET <= HWY_AVX3
    if constexpr (kIntervals == 8 && sizeof(T) == 8)
      return V{_mm512_permutexvar_pd(interval.raw, _mm512_load_pd(of_intervals))};
    if constexpr (kIntervals == 16)
      return V{_mm512_permutexvar_ps(interval.raw, _mm512_load_ps(of_intervals))};
#elif HWY_TARGET <= HWY_AVX2
    if constexpr (kIntervals == 8)
      return V{_mm256_permutevar8x32_ps(_mm256_load_ps(of_intervals), interval.raw)};
#endif
    return hn::Set(D(), *of_intervals);
  }

  T scale_;
  int terms_;
  alignas(64) T number_[kMostScreeningNumbers];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
