#pragma once

#include <cstddef>
#include <vector>

#include "forcefield/clusters/aligned.hpp"

namespace taut {

inline constexpr int kLanes = 8;  // sequences transformed side by side

// Number k of eight sequences side by side: at re + k·apart and im + k·apart.
template <class T>
struct Columns {
  T *re, *im;
  std::ptrdiff_t apart;
};

// Z(k) = Σ z(j) e^(−2πijk/size), not normalized, by passes of small radices that leave numbers in order
// (Stockham's; Cochran et al. 1967, doi:10.1109/TAU.1967.1161900). Before a pass, what is left are `together`
// interleaved sequences of radix · groups numbers each. Radices: 4, 2, 3, 5, 7, and primes as they are.
template <class T>
struct FourierPlan {
  struct Pass {
    int radix, groups, together;
    std::size_t roots;  // where its own begin
  };

  explicit FourierPlan(int size);

  int size;
  std::vector<Pass> passes;
  // Of a pass: e^(−2πij/radix), and of each group those its radix − 1 further numbers are turned by.
  Aligned<T> roots;
};

// Room that a transform of so many numbers takes on the way.
constexpr std::size_t fourier_room(int size) {
  return std::size_t{4} * kLanes * size;
}

// `to` may be `from`. The other way: with re and im of both exchanged.
template <class T>
void transform(const FourierPlan<T>& plan, const Columns<T>& from, const Columns<T>& to, T* room);

// Transforms of real sequences a and b in that of a + ib: a's (its numbers 0 … size/2), and b's a vector
// further on; and back, without the half. Back, first and middle numbers count as real: in a skewed box a
// wave at the grid's end and its mirror image are damped unlike, and their mean is what counts.
template <class T>
void part_real(int size, const Columns<T>& both, const Columns<T>& parts);
template <class T>
void join_real(int size, const Columns<T>& parts, const Columns<T>& both);

// columns[k][lane] = rows[lane·apart + k], k < size rounded up to whole vectors; and back.
template <class T>
void rows_to_columns(int size, const T* rows, std::ptrdiff_t apart, T* columns);
template <class T>
void columns_to_rows(int size, const T* columns, T* rows, std::ptrdiff_t apart);

// Each number times its factor g ≥ 0, and what Σ g|z|² then is, of what z was.
template <class T>
double filter(int size, const T* factor, const Columns<T>& z);

}  // namespace taut
