// Loads and stores molecules of three atoms, nine numbers each. Compiled once for each SIMD target.
#if defined(TAUT_NINES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_NINES_INL_H
#undef TAUT_NINES_INL_H
#else
#define TAUT_NINES_INL_H
#endif

#include <cstring>

#include "constraints/batch/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Nine vectors, either in memory order or in rows: row c has coordinate c of one molecule per lane.
struct Nine {
  V n[9];

  HWY_INLINE V3 atom(int a) const { return {n[3 * a], n[3 * a + 1], n[3 * a + 2]}; }
};

HWY_INLINE V load_any(const double* numbers) {
  return hn::LoadU(D(), numbers);
}
HWY_INLINE void store_any(V v, double* numbers) {
  hn::StoreU(v, D(), numbers);
}
HWY_INLINE Nine load_nine(const double* numbers) {
  Nine t;
  for (int k = 0; k < 9; ++k) t.n[k] = load_any(numbers + k * kWidth);
  return t;
}

// w consecutive molecules fill nine vectors of w numbers. Lane j of vector k is number wk + j = 9m + c,
// coordinate c of molecule m. Modulo w (1, 2, 4 or 8) this gives j = m + c; modulo 9, where w·(8/w) = −1, it
// gives k = s(j − c) with s = 8/w. Row c therefore lies in vectors whose index grows by s from lane to lane,
// rotated by c lanes. To align it, lane j takes the vector s·j further on: one choice between two vectors for
// each binary digit of j.
HWY_INLINE constexpr int modulo9(int k) {
  return (k % 9 + 9) % 9;
}
inline constexpr int kUp = 8 / kWidth;

// Lane j of t[k] ← lane j of t[k ± s·j]
template <int kSign>
HWY_INLINE void line_up(Nine& t) {
  constexpr std::uint8_t kLanesWith[4 + 8] = {0, 0xAA, 0xCC, 0, 0xF0};  // 8 bytes are read from each
  for (int digit = 1; digit < kWidth; digit *= 2) {
    const M with = hn::LoadMaskBits(D(), kLanesWith + digit);
    const Nine from = t;
    for (int k = 0; k < 9; ++k)
      t.n[k] = hn::IfThenElse(with, from.n[modulo9(k + kSign * kUp * digit)], from.n[k]);
  }
}

// Lane m ← lane m + by
template <int kBy>
HWY_INLINE V turned(V v) {
  if constexpr (kBy % kWidth == 0) return v;
#if HWY_TARGET <= HWY_AVX3
  const __m512i bits = _mm512_castpd_si512(v.raw);
  return V{_mm512_castsi512_pd(_mm512_alignr_epi64(bits, bits, kBy & 7))};
#else
  HWY_ALIGN std::int64_t from[kWidth];
  for (int l = 0; l < kWidth; ++l) from[l] = (l + kBy + 8) % kWidth;
  return hn::TableLookupLanes(v, hn::SetTableIndices(D(), from));
#endif
}

template <std::size_t... c>
HWY_INLINE Nine rows_of(Nine t, std::index_sequence<c...>) {
  line_up<1>(t);
  return {turned<c>(t.n[modulo9(-kUp * static_cast<int>(c))])...};
}
HWY_INLINE Nine rows_of(const Nine& numbers) {
  return rows_of(numbers, std::make_index_sequence<9>());
}
template <std::size_t... c>
HWY_INLINE Nine numbers_of(const Nine& rows, std::index_sequence<c...>) {
  Nine t;
  ((t.n[modulo9(-kUp * static_cast<int>(c))] = turned<-static_cast<int>(c)>(rows.n[c])), ...);
  line_up<-1>(t);
  return t;
}
HWY_INLINE Nine numbers_of(const Nine& rows) {
  return numbers_of(rows, std::make_index_sequence<9>());
}

// The numbers of a part's molecules: in the array itself if they are contiguous there, else in a copy.
class Nines {
 public:
  HWY_INLINE explicit Nines(const Part& part)
      : part_(part),
        contiguous_(part.batch.ascending &&
                    part.places()[kWidth - 1] == part.places()[0] + 9 * (kWidth - 1)) {}
  template <class T>
  HWY_INLINE T* open(T* array, double* copy) const {
    if (contiguous_) return array + part_.places()[0];
    copy_in(part_, array, copy);
    return copy;
  }
  HWY_INLINE void close(const double* copy, double* array) const {
    if (!contiguous_) copy_out(part_, copy, array);
  }

 private:
  // Calls copy(address in the copy, address in the array) for each atom, or for each molecule with contiguous
  // atoms. It copies by vectors, because a load that spans two narrower stores waits for both.
  static HWY_INLINE void by_pieces(const Part& part, const auto& copy_nine, const auto& copy_three) {
    for (int lane = 0; lane < kWidth; ++lane)
      if (part.batch.contiguous)
        copy_nine(9 * lane, part.places()[lane]);
      else
        for (int atom = 0; atom < 3; ++atom)
          copy_three(9 * lane + 3 * atom, part.places()[atom * kLanes + lane]);
  }
  static HWY_INLINE void copy_nine(const double* from, double* to) {
    for (int k = 0; k + kWidth <= 9; k += kWidth) store_any(load_any(from + k), to + k);
    to[8] = from[8];
  }
  static HWY_NOINLINE void copy_in(const Part& part, const double* array, double* copy) {
    by_pieces(
        part, [&](int to, int from) HWY_ATTR { copy_nine(array + from, copy + to); },
        [&](int to, int from) HWY_ATTR { std::memcpy(copy + to, array + from, 3 * sizeof(double)); });
  }
  static HWY_NOINLINE void copy_out(const Part& part, const double* copy, double* array) {
    by_pieces(
        part, [&](int from, int to) HWY_ATTR { copy_nine(copy + from, array + to); },
        [&](int from, int to) HWY_ATTR { std::memcpy(array + to, copy + from, 3 * sizeof(double)); });
  }

  const Part& part_;
  bool contiguous_;
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
