#pragma once

#include <fftw3.h>

#include <array>
#include <complex>
#include <memory>

#include "forcefield/clusters/aligned.hpp"

namespace taut {

// Transforms of a real grid of n₁ × n₂ × n₃, plane by plane and then across the planes, row by row: in parts
// that threads can share out. Rows of real numbers have room for `beyond` more, and all begin on 16 bytes.
// Planned by rule, not by the clock: the same bits each time.
class FourierGrid {
 public:
  using Complex = std::complex<double>;

  FourierGrid(std::array<int, 3> size, int beyond);

  std::array<int, 3> size() const { return n_; }
  int half() const { return n_[2] / 2 + 1; }  // complex numbers a row
  int stride() const { return stride_; }      // real numbers a row
  double* plane(int k1) { return real_.data() + std::ptrdiff_t{k1} * n_[1] * stride_; }
  // The row k₂ of plane k₁.
  Complex* row(int k1, int k2) { return complex_.data() + (std::ptrdiff_t{k1} * n_[1] + k2) * half(); }

  void transform_plane(int k1);
  void transform_across(int k2);
  void transform_back_across(int k2);
  void transform_plane_back(int k1);  // its complex numbers are lost

 private:
  struct Destroy {
    void operator()(fftw_plan_s* plan) const;
  };
  using Plan = std::unique_ptr<fftw_plan_s, Destroy>;

  std::array<int, 3> n_;
  int stride_;
  Aligned<double> real_;
  Aligned<Complex> complex_;
  Plan plane_, plane_back_, across_, across_back_;
};

}  // namespace taut
