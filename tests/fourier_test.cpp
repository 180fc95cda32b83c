#include "forcefield/ewald/fourier.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>
#include <random>

#include "every_machine.hpp"
#include "forcefield/ewald/mesh_kernels.hpp"

namespace taut::fourier_tests {
namespace {

using namespace tests;
using Sizes = std::array<int, 3>;

std::complex<double> root(long numerator, int size) {
  return std::polar(1.0, -2 * std::numbers::pi * double(numerator % size) / size);
}

// Random numbers on a grid, and their transform by the sum as it stands, an edge after the other.
struct Plain {
  Sizes n;
  std::vector<std::complex<double>> z;

  explicit Plain(const Sizes& size) : n(size) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int k = 0; k < n[0] * n[1] * n[2]; ++k) z.emplace_back(number(rng));
  }
  std::complex<double>& at(const Sizes& k) { return z[(k[0] * n[1] + k[1]) * n[2] + k[2]]; }

  Plain transformed() const {
    Plain from = *this, to = *this;
    for (int edge = 0; edge < 3; ++edge, from = to)
      to.each([&](Sizes k) {
        const int wave = k[edge];
        std::complex<double> sum = 0;
        for (k[edge] = 0; k[edge] < n[edge]; ++k[edge])
          sum += from.at(k) * root(long(k[edge]) * wave, n[edge]);
        k[edge] = wave;
        to.at(k) = sum;
      });
    return to;
  }
  void each(const auto& work) const {
    for (int a = 0; a < n[0]; ++a)
      for (int b = 0; b < n[1]; ++b)
        for (int c = 0; c < n[2]; ++c) work(Sizes{a, b, c});
  }
};

// There, and by a factor of two back again.
template <class T>
void compare(const Sizes& n, double digits) {
  SCOPED_TRACE(::testing::PrintToString(n));
  Plain plain(n);
  Plain waves = plain.transformed();
  const double points = n[0] * n[1] * n[2];
  FourierGrid<T> grid(n, 3);
  grid.make_room(1);
  plain.each([&](const Sizes& k) {
    grid.plane(k[0])[k[1] * grid.stride() + k[2]] = static_cast<T>(plain.at(k).real());
  });
  double error = 0, sum = 0;
  for (int k1 = 0; k1 < n[0]; ++k1) grid.transform_plane(k1, 0);
  const auto two = std::vector<T>(n[0] * n[2], T(2));
  for (int k2 = 0; k2 < grid.half(); ++k2) {
    auto* const z = grid.transform_row(k2, 0);
    for (int k1 = 0; k1 < n[0]; ++k1)
      for (int k3 = 0; k3 < n[2]; ++k3)
        error = std::max(error, std::abs(waves.at({k1, k2, k3}) - std::complex<double>(z[k3 * n[0] + k1])));
    sum += (k2 == 0 || 2 * k2 == n[1] ? 1 : 2) * solve(std::span<const T>(two), z);
    grid.transform_row_back(k2, 0);
  }
  EXPECT_LT(error, digits * std::sqrt(points));
  double squares = 0;
  for (const auto& z : plain.z) squares += std::norm(z);
  EXPECT_NEAR(sum / points, 2 * squares, digits * squares);  // Parseval's
  for (int k1 = 0; k1 < n[0]; ++k1) grid.transform_plane_back(k1, 0);
  double back = 0;
  plain.each([&](const Sizes& k) {
    back = std::max(back, std::abs(double(grid.plane(k[0])[k[1] * grid.stride() + k[2]]) / (2 * points) -
                                   plain.at(k).real()));
  });
  EXPECT_LT(back, digits);
}

// Every radix, alone and with others, along every edge; lengths that fill vectors and that do not.
TEST(Fourier, IsTheSumAsItStands) {
  on_every_machine([] {
    for (const Sizes& n : {Sizes{8, 12, 16},
                           {6, 10, 14},
                           {16, 15, 20},
                           {5, 7, 8},
                           {22, 6, 13},
                           {13, 11, 9},
                           {7, 26, 25},
                           {9, 8, 6},
                           {24, 21, 49},
                           {18, 27, 36},
                           {54, 16, 32},
                           {20, 17, 40},
                           {12, 13, 34}}) {
      compare<double>(n, 1e-14);
      compare<float>(n, 2e-6);
    }
  });
}

}  // namespace
}  // namespace taut::fourier_tests
