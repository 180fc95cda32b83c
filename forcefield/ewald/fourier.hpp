#pragma once

#include <array>
#include <complex>
#include <vector>

#include "base/aligned.hpp"
#include "forcefield/ewald/fourier_kernels.hpp"

namespace taut {

// Transforms of a real grid of n₁ × n₂ × n₃, not normalized, Z(k) = Σ z(j) e^(−2πijk/n) along each edge: along the
// second edge plane by plane, real to complex, then along the first and the third, a row k₂ of all planes at a time: in
// parts that threads can share out. Two real sequences, neighbours along the third edge, are the real and the imaginary
// part of one.
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
  struct Room {
    Aligned<Complex> one, other;
    Aligned<T> scratch;
  };
  Complex* row(int k1, int k2) { return complex_.data() + (std::ptrdiff_t{k1} * half() + k2) * width_; }
  // Rows of a plane from −n₂/2 on, k₂, between real rows and their transforms: pairs of real numbers.
  int pairs() const { return width_ / 2; }
  Complex* pairs_of(int k2, Room& room) const {
    return room.one.data() + std::ptrdiff_t{k2 < 0 ? k2 + n_[1] : k2} * pairs();
  }
  Sequences<T> along_second(int k1) { return {reinterpret_cast<Complex*>(plane(k1)), stride_ / 2}; }
  Sequences<T> along_first(int k2) { return {row(0, k2), std::ptrdiff_t{half()} * width_}; }

  std::array<int, 3> n_;
  int width_;  // complex numbers a row
  int stride_, rows_;
  std::array<FourierPlan<T>, 3> plan_;  // each edge
  Aligned<T> real_;
  Aligned<Complex> complex_;
  std::vector<Room> room_;  // by thread
};

extern template class FourierGrid<double>;
extern template class FourierGrid<float>;

}  // namespace taut
