#include "forcefield/pme/fourier.hpp"

#include <mutex>

namespace taut {
namespace {

fftw_complex* fftw(std::complex<double>* z) {
  return reinterpret_cast<fftw_complex*>(z);
}

constexpr unsigned kByRule = FFTW_ESTIMATE;

// FFTW makes and destroys plans on one thread at a time.
std::mutex& planner() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

}  // namespace

FourierGrid::FourierGrid(std::array<int, 3> size, int beyond)
    : n_(size),
      stride_((size[2] + beyond + 1) / 2 * 2),
      real_(std::size_t(n_[0]) * n_[1] * stride_),
      complex_(std::size_t(n_[0]) * n_[1] * half()) {
  const std::lock_guard alone(planner());
  const int real_rows[] = {n_[1], stride_}, complex_rows[] = {n_[1], half()};
  plane_.reset(fftw_plan_many_dft_r2c(2, &n_[1], 1, plane(0), real_rows, 1, 0, fftw(row(0, 0)), complex_rows,
                                      1, 0, kByRule));
  plane_back_.reset(fftw_plan_many_dft_c2r(2, &n_[1], 1, fftw(row(0, 0)), complex_rows, 1, 0, plane(0),
                                           real_rows, 1, 0, kByRule));
  const int apart = n_[1] * half();
  for (const int sign : {FFTW_FORWARD, FFTW_BACKWARD})
    (sign == FFTW_FORWARD ? across_ : across_back_)
        .reset(fftw_plan_many_dft(1, n_.data(), half(), fftw(row(0, 0)), nullptr, apart, 1, fftw(row(0, 0)),
                                  nullptr, apart, 1, sign, kByRule));
}

void FourierGrid::Destroy::operator()(fftw_plan_s* plan) const {
  const std::lock_guard alone(planner());
  fftw_destroy_plan(plan);
}

void FourierGrid::transform_plane(int k1) {
  fftw_execute_dft_r2c(plane_.get(), plane(k1), fftw(row(k1, 0)));
}
void FourierGrid::transform_plane_back(int k1) {
  fftw_execute_dft_c2r(plane_back_.get(), fftw(row(k1, 0)), plane(k1));
}
void FourierGrid::transform_across(int k2) {
  fftw_execute_dft(across_.get(), fftw(row(0, k2)), fftw(row(0, k2)));
}
void FourierGrid::transform_back_across(int k2) {
  fftw_execute_dft(across_back_.get(), fftw(row(0, k2)), fftw(row(0, k2)));
}

}  // namespace taut
