#include "forcefield/pme/fourier.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {
namespace {

// Fours first, then primes. At least two: no pass then writes where it reads.
std::vector<int> radices(int size) {
  std::vector<int> all;
  for (; size % 4 == 0; size /= 4) all.push_back(4);
  for (int prime = 2; size > 1; ++prime)
    for (; size % prime == 0; size /= prime) all.push_back(prime);
  if (all.size() < 2) all.insert(all.begin(), 2 - all.size(), 1);
  return all;
}

int whole(int n, int of) {
  return (n + of - 1) / of * of;
}

template <class T>
Columns<T> exchanged(const Columns<T>& z) {
  return {z.im, z.re, z.apart};
}

}  // namespace

template <class T>
FourierPlan<T>::FourierPlan(int n) : size(n) {
  const auto add_root = [&](long numerator, int denominator) {
    const double angle = 2 * std::numbers::pi * double(numerator % denominator) / denominator;
    roots.push_back(static_cast<T>(std::cos(angle)));
    roots.push_back(static_cast<T>(-std::sin(angle)));
  };
  int left = n;
  for (const int radix : radices(n)) {
    passes.push_back({radix, left / radix, n / left, roots.size()});
    for (int j = 0; j < radix; ++j) add_root(j, radix);
    for (long p = 0; p < left / radix; ++p)
      for (int k = 1; k < radix; ++k) add_root(p * k, left);
    left /= radix;
  }
}

template <class T>
FourierGrid<T>::FourierGrid(std::array<int, 3> size, int beyond)
    : n_(size),
      width_(whole(size[2], 2 * kLanes)),
      stride_(std::max(width_, whole(size[2] + beyond, kLanes))),
      longest_(whole(*std::max_element(size.begin(), size.end()), kLanes)),
      plan_{FourierPlan<T>(size[0]), FourierPlan<T>(size[1]), FourierPlan<T>(size[2])},
      real_(std::size_t(n_[0]) * n_[1] * stride_),
      complex_(std::size_t(batches()) * kLanes * plane_apart()) {}

// Two vectors' columns are the real and the imaginary parts of one.
template <class T>
void FourierGrid<T>::transform_plane(int k1, int thread) {
  const Columns<T> both = columns(thread);
  for (int k3 = 0; k3 < n_[2]; k3 += 2 * kLanes) {
    T *const in = plane(k1) + k3, *const out = row(k1, 0) + k3;
    transform(plan_[1], {in, in + kLanes, stride_}, both, on_the_way(thread));
    part_real(n_[1], both, {out, out + width_, 2 * width_});
  }
}

template <class T>
void FourierGrid<T>::transform_plane_back(int k1, int thread) {
  const Columns<T> both = columns(thread);
  for (int k3 = 0; k3 < n_[2]; k3 += 2 * kLanes) {
    T *const in = row(k1, 0) + k3, *const out = plane(k1) + k3;
    join_real(n_[1], {in, in + width_, 2 * width_}, both);
    transform(plan_[1], exchanged(both), {out + kLanes, out, stride_}, on_the_way(thread));
  }
}

template <class T>
void FourierGrid<T>::transform_across(int k2, int thread) {
  for (int k3 = 0; k3 < n_[2]; k3 += kLanes) {
    const Columns<T> z{row(0, k2) + k3, row(0, k2) + width_ + k3, plane_apart()};
    transform(plan_[0], z, z, on_the_way(thread));
  }
}

template <class T>
void FourierGrid<T>::transform_back_across(int k2, int thread) {
  for (int k3 = 0; k3 < n_[2]; k3 += kLanes) {
    const Columns<T> z{row(0, k2) + width_ + k3, row(0, k2) + k3, plane_apart()};
    transform(plan_[0], z, z, on_the_way(thread));
  }
}

template <class T>
Columns<T> FourierGrid<T>::transform_along(int batch, int k2, int thread) {
  const Columns<T> z = columns(thread);
  const T* rows = row(kLanes * batch, k2);
  rows_to_columns(n_[2], rows, plane_apart(), z.re);
  rows_to_columns(n_[2], rows + width_, plane_apart(), z.im);
  transform(plan_[2], z, z, on_the_way(thread));
  return z;
}

template <class T>
void FourierGrid<T>::transform_back_along(int batch, int k2, int thread) {
  const Columns<T> z = columns(thread);
  T* rows = row(kLanes * batch, k2);
  transform(plan_[2], exchanged(z), exchanged(z), on_the_way(thread));
  columns_to_rows(n_[2], z.re, rows, plane_apart());
  columns_to_rows(n_[2], z.im, rows + width_, plane_apart());
}

template class FourierGrid<double>;
template class FourierGrid<float>;

}  // namespace taut
