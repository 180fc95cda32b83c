#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace taut {

// Sequences of complex numbers in memory. Number k of sequence l is first[k·apart + l] where they lie side by side, and
// first[l·apart + k] where one follows another.
enum class Layout { kSideBySide, kInTurn };
template <class T>
struct Sequences {
  std::complex<T>* first;
  std::ptrdiff_t apart;
  Layout layout = Layout::kSideBySide;
};

// How sequences of one length n are transformed, Z(k) = Σ z(j) ω^(jk), ω = e^(−2πi/n): by Stockham's stages, which leave
// the waves in order and need no table of places (Van Loan 1992, Computational Frameworks for the Fast Fourier Transform,
// doi:10.1137/1.9781611970999, §1.7). n is a product of radices r₁r₂…. A stage takes s transforms of length r·m that lie
// side by side, number l of transform q at s·l + q, to s·r transforms of length m, with
//     y(q + s(rp + j)) = ω^(sjp) Σₖ x(q + s(p + mk)) e^(−2πijk/r),   p < m, j and k < r, q < s.
// Lanes of a vector hold different sequences, so that all of them do the same.
template <class T>
class FourierPlan {
 public:
  struct Stage {
    int radix, rest;                      // r, m
    std::vector<std::complex<T>> roots;   // e^(−2πik/r), k < r
    std::vector<std::complex<T>> turned;  // ω^(sjp), j = 1 … r − 1 of p = 0, then of p = 1 …
  };
  explicit FourierPlan(int length);

  int length() const { return length_; }
  std::span<const Stage> stages() const { return stages_; }
  // Numbers of scratch memory that a transform needs: two copies of as many sequences as a vector has lanes.
  std::size_t scratch() const { return std::size_t{2} * length_ * 2 * kMostLanes; }

 private:
  static constexpr int kMostLanes = 64 / sizeof(T);
  int length_;
  std::vector<Stage> stages_;
};

extern template class FourierPlan<double>;
extern template class FourierPlan<float>;

// Transforms so many sequences from one place to another that does not overlap it; backward with e^(+2πijk/n).
enum class Direction { kForward, kBackward };
template <class T>
void transform_sequences(const FourierPlan<T>& plan, Direction direction, const Sequences<T>& from,
                         const Sequences<T>& to, int count, T* scratch);

// Of a row of complex numbers a + ib, of which a and b are the transforms of real rows: from Z(k) and Z(−k)
//     a = (Z(k) + Z*(−k))/2,   b = (Z(k) − Z*(−k))/2i,
// stored in turns; and back. Where Z(k) and Z(−k) are one number, a and b are real.
template <class T>
void separate_pairs(const std::complex<T>* up, const std::complex<T>* down, int count,
                    std::complex<T>* parts);
template <class T>
void join_pairs(const std::complex<T>* parts, int count, std::complex<T>* up, std::complex<T>* down);

}  // namespace taut
