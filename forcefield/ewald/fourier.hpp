#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "base/aligned.hpp"

namespace taut {

// Transforms of a real grid of n₁ × n₂ × n₃, not normalized, Z(k) = Σ z(j) e^(−2πijk/n) along each edge, by
// FFTW (Frigo & Johnson 2005, doi:10.1109/JPROC.2004.840301): along the second edge plane by plane, real to
// complex, then along the third and the first, a row k₂ of all planes at a time: in parts that threads can
// share out. FFTW is given what it does fastest, many sequences side by side from one place to another; two
// real ones, neighbours along the third edge, are the real and the imaginary part of one. Its plans are
// estimated, not timed: the same bits each time.
template <class T>
class FourierGrid {
 public:
  using Complex = std::complex<T>;

  // Planes of real numbers have room for `beyond` more rows, and rows for at least as many more numbers.
  FourierGrid(std::array<int, 3> size, int beyond);

  // Allocates scratch memory for so many threads, before the transforms.
  void make_room(int threads);

  int half() const { return n_[1] / 2 + 1; }                                // rows of complex numbers a plane
  int stride() const { return stride_; }                                    // real numbers a row
  std::ptrdiff_t apart() const { return std::ptrdiff_t{rows_} * stride_; }  // a plane
  T* plane(int k1) { return real_.data() + k1 * apart(); }

  void transform_plane(int k1, int thread);
  void transform_plane_back(int k1, int thread);
  // The row k₂ of all planes, transformed: z(k₁, k₂, k₃) at n₁k₃ + k₁, the thread's until it asks for
  // another; and back what it then is.
  Complex* transform_row(int k2, int thread);
  void transform_row_back(int k2, int thread);

 private:
  using Plan = std::shared_ptr<void>;  // FFTW's
  struct Ways {
    Plan there, back;
  };
  // Of `edge`, so many sequences: neighbouring numbers of one, and of neighbouring ones, so far apart.
  struct Layout {
    Complex* first;
    int along, across;
  };
  Ways plan(int edge, int sequences, const Layout& from, const Layout& to) const;

  Complex* row(int k1, int k2) { return complex_.data() + (std::ptrdiff_t{k1} * half() + k2) * width_; }
  Complex* one(int thread) { return room_[thread].data(); }
  // The row k₂ of a plane on its way, from −n₂/2 on.
  Complex* both(int k2, int thread) {
    return one(thread) + std::ptrdiff_t{k2 < 0 ? k2 + n_[1] : k2} * (width_ / 2);
  }
  Complex* other(int thread) { return one(thread) + room_[thread].size() / 2; }

  std::array<int, 3> n_;
  int width_;  // complex numbers a row
  int stride_, rows_;
  Aligned<T> real_;
  Aligned<Complex> complex_;
  std::vector<Aligned<Complex>> room_;  // by thread
  std::array<Ways, 3> along_;           // each edge
};

extern template class FourierGrid<double>;
extern template class FourierGrid<float>;

}  // namespace taut
