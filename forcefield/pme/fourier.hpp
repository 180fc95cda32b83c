#pragma once

#include <array>
#include <vector>

#include "forcefield/pme/fourier_kernels.hpp"

namespace taut {

// Transforms of a real grid of n₁ × n₂ × n₃: along the second edge plane by plane, real to complex, then
// along the first and the third, a row k₂ of all planes at a time: in parts that threads can share out. Eight
// sequences lie side by side, as neighbours along the third edge; along that edge itself, rows of eight
// planes are turned into columns and back, which costs about as much as a pass over them.
template <class T>
class FourierGrid {
 public:
  // Rows of real numbers have room for `beyond` more.
  FourierGrid(std::array<int, 3> size, int beyond);

  // Before what follows, which each thread does in room of its own.
  void make_room(int threads) {
    if (threads > static_cast<int>(room_.size())) room_.resize(threads, Aligned<T>(room()));
  }

  int half() const { return n_[1] / 2 + 1; }                     // rows of complex numbers a plane
  int batches() const { return (n_[0] + kLanes - 1) / kLanes; }  // of planes
  int stride() const { return stride_; }                         // real numbers a row
  T* plane(int k1) { return real_.data() + std::ptrdiff_t{k1} * n_[1] * stride_; }

  void transform_plane(int k1, int thread);
  void transform_plane_back(int k1, int thread);

  // Of the row k₂ of all planes, transformed: use(batch, z), with z(k₁, k₂, k₃) at 8k₃ + k₁ mod 8 in re and
  // im.
  void with_row(int k2, int thread, auto use) {
    transform_across(k2, thread);
    for (int batch = 0; batch < batches(); ++batch) use(batch, transform_along(batch, k2, thread));
  }
  // The same, and then transformed back along both edges.
  void filter_row(int k2, int thread, auto use) {
    with_row(k2, thread, [&](int batch, const Columns<T>& z) {
      use(batch, z);
      transform_back_along(batch, k2, thread);
    });
    transform_back_across(k2, thread);
  }

 private:
  // The row k₂ of plane k₁, of as many planes as fill the batches.
  T* row(int k1, int k2) { return complex_.data() + (std::ptrdiff_t{k1} * half() + k2) * 2 * width_; }
  std::ptrdiff_t plane_apart() const { return std::ptrdiff_t{2} * half() * width_; }
  // By thread: numbers of eight sequences, and what transforms of them take.
  std::size_t room() const { return longest_ * std::size_t{2} * kLanes + fourier_room(longest_); }
  Columns<T> columns(int thread) {
    T* const begin = room_[thread].data();
    return {begin, begin + std::ptrdiff_t{longest_} * kLanes, kLanes};
  }
  T* on_the_way(int thread) { return room_[thread].data() + std::ptrdiff_t{longest_} * 2 * kLanes; }

  void transform_across(int k2, int thread);
  void transform_back_across(int k2, int thread);
  Columns<T> transform_along(int batch, int k2, int thread);
  void transform_back_along(int batch, int k2, int thread);

  std::array<int, 3> n_;
  int width_;  // complex numbers a row: real ones and imaginary ones, each in whole vectors, two and two
  int stride_;
  int longest_;  // edge, in whole vectors
  std::array<FourierPlan<T>, 3> plan_;
  Aligned<T> real_, complex_;
  std::vector<Aligned<T>> room_;
};

extern template class FourierGrid<double>;
extern template class FourierGrid<float>;

}  // namespace taut
