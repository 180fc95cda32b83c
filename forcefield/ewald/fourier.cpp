#include "forcefield/ewald/fourier.hpp"

#include <fftw3.h>

#include <algorithm>
#include <mutex>

namespace taut {
namespace {

template <class T>
struct Fftw;
template <>
struct Fftw<double> {
  using Number = fftw_complex;
  using Plan = fftw_plan;
  static constexpr auto kPlan = fftw_plan_many_dft;
  static constexpr auto kExecute = fftw_execute_dft;
  static constexpr auto kDestroy = fftw_destroy_plan;
};
template <>
struct Fftw<float> {
  using Number = fftwf_complex;
  using Plan = fftwf_plan;
  static constexpr auto kPlan = fftwf_plan_many_dft;
  static constexpr auto kExecute = fftwf_execute_dft;
  static constexpr auto kDestroy = fftwf_destroy_plan;
};

// It makes and destroys plans on one thread at a time.
std::mutex& planner() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

template <class T>
auto* fftw(std::complex<T>* z) {
  return reinterpret_cast<typename Fftw<T>::Number*>(z);
}
template <class T>
std::complex<T>* pairs(T* numbers) {
  return reinterpret_cast<std::complex<T>*>(numbers);
}

template <class T>
void destroy(void* plan) {
  const std::lock_guard alone(planner());
  Fftw<T>::kDestroy(static_cast<typename Fftw<T>::Plan>(plan));
}

// By a plan made for other places, in memory aligned alike.
template <class T>
void execute(const std::shared_ptr<void>& plan, std::complex<T>* from, std::complex<T>* to) {
  Fftw<T>::kExecute(static_cast<typename Fftw<T>::Plan>(plan.get()), fftw(from), fftw(to));
}

constexpr int kWhole = 8;  // numbers a row: all rows are aligned alike

int whole(int n, int of) {
  return (n + of - 1) / of * of;
}

template <class T>
std::complex<T> i_times(const std::complex<T>& z) {
  return {-z.imag(), z.real()};
}

}  // namespace

template <class T>
FourierGrid<T>::FourierGrid(std::array<int, 3> size, int beyond)
    : n_(size),
      width_(whole(size[2], kWhole)),
      stride_(whole(size[2] + beyond, kWhole)),
      rows_(size[1] + beyond),
      real_(n_[0] * apart()),
      complex_(std::size_t(n_[0]) * half() * width_) {
  make_room(1);
  const int pairs_of_row = width_ / 2, row_of_next_plane = half() * width_;
  along_[1] = plan(1, pairs_of_row, {pairs(plane(0)), stride_ / 2, 1}, {one(0), pairs_of_row, 1});
  along_[2] = plan(2, n_[0], {row(0, 0), 1, row_of_next_plane}, {one(0), 1, n_[2]});
  along_[0] = plan(0, n_[2], {one(0), n_[2], 1}, {other(0), 1, n_[0]});
}

template <class T>
auto FourierGrid<T>::plan(int edge, int sequences, const Layout& from, const Layout& to) const -> Ways {
  const auto of = [&](const Layout& a, const Layout& b, int sign) {
    const std::lock_guard alone(planner());
    return Plan(Fftw<T>::kPlan(1, &n_[edge], sequences, fftw(a.first), nullptr, a.along, a.across,
                               fftw(b.first), nullptr, b.along, b.across, sign, FFTW_ESTIMATE),
                destroy<T>);
  };
  return {of(from, to, FFTW_FORWARD), of(to, from, FFTW_BACKWARD)};
}

template <class T>
void FourierGrid<T>::make_room(int threads) {
  const std::size_t numbers = whole(std::max(n_[1] * width_ / 2, n_[0] * n_[2]), kWhole);
  if (threads > static_cast<int>(room_.size())) room_.resize(threads, Aligned<Complex>(2 * numbers));
}

// a = (Z(k) + Z*(−k))/2, b = (Z(k) − Z*(−k))/2i of Z, the transform of a + ib.
template <class T>
void FourierGrid<T>::transform_plane(int k1, int thread) {
  execute(along_[1].there, pairs(plane(k1)), one(thread));
  for (int k2 = 0; k2 < half(); ++k2) {
    const Complex *up = both(k2, thread), *down = both(-k2, thread);
    Complex* const parts = row(k1, k2);
    for (int j = 0; j < width_ / 2; ++j) {
      parts[2 * j] = T(0.5) * (up[j] + std::conj(down[j]));
      parts[2 * j + 1] = T(0.5) * i_times(std::conj(down[j]) - up[j]);
    }
  }
}

// Without the half. First and middle numbers count as real, as those of a real row are.
template <class T>
void FourierGrid<T>::transform_plane_back(int k1, int thread) {
  for (int k2 = 0; k2 < half(); ++k2) {
    Complex *up = both(k2, thread), *down = both(-k2, thread);
    const Complex* const parts = row(k1, k2);
    if (up == down)
      for (int j = 0; j < width_ / 2; ++j) up[j] = {parts[2 * j].real(), parts[2 * j + 1].real()};
    else
      for (int j = 0; j < width_ / 2; ++j) {
        up[j] = parts[2 * j] + i_times(parts[2 * j + 1]);
        down[j] = std::conj(parts[2 * j] - i_times(parts[2 * j + 1]));
      }
  }
  execute(along_[1].back, one(thread), pairs(plane(k1)));
}

template <class T>
auto FourierGrid<T>::transform_row(int k2, int thread) -> Complex* {
  execute(along_[2].there, row(0, k2), one(thread));
  execute(along_[0].there, one(thread), other(thread));
  return other(thread);
}

template <class T>
void FourierGrid<T>::transform_row_back(int k2, int thread) {
  execute(along_[0].back, other(thread), one(thread));
  execute(along_[2].back, one(thread), row(0, k2));
}

template class FourierGrid<double>;
template class FourierGrid<float>;

}  // namespace taut
