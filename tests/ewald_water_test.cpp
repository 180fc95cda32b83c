// Energies of SPC/E water that the National Institute of Standards and Technology has published, a part at a
// time: https://www.nist.gov/mml/csd/chemical-informatics-group/spce-water-reference-calculations-10a-cutoff
// Energies in kelvin, as published, to six digits: α = 5.6/L, images up to 1 nm, waves of k² < 27.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>

#include "forcefield/ewald/pme.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "forcefield/pairs/dispersion.hpp"
#include "md/units.hpp"

namespace taut::ewald_water_tests {
namespace {

using std::numbers::pi;

constexpr double kEdge = 2, kAlpha = 5.6 / kEdge;  // [nm], [1/nm]

struct Water {
  Nonbonded nb;
  Box box{Vec3::Constant(kEdge)};
  Vectors x{3, 300};

  Water() {
    std::ifstream file(TAUT_TEST_DATA "/nist-spce-1.txt");
    std::string line;
    for (int a = 0; a < 300;) {
      if (!std::getline(file, line)) throw std::runtime_error("nist-spce-1.txt is short");
      if (line[0] == '#') continue;
      std::istringstream(line) >> x(0, a) >> x(1, a) >> x(2, a);
      ++a;
    }
    x /= 10;
    nb.charge.resize(300);
    nb.sigma.setConstant(300, 0.316555789);
    nb.epsilon.setZero(300);
    for (int o = 0; o < 300; o += 3) {
      nb.epsilon[o] = 78.19743111 * kBoltzmann;
      nb.charge.segment<3>(o) << -0.8476, 0.4238, 0.4238;
      for (int h = o + 1; h < o + 3; ++h) x.col(h) = x.col(o) + box.nearest_image(x.col(h) - x.col(o));
      for (const auto& [i, j] : {std::pair(o, o + 1), {o, o + 2}, {o + 1, o + 2}})
        nb.exceptions.push_back({i, j, 0, 0.3, 0});
    }
    nb.cutoff = 1.0;
    nb.pme = PmeParameters{.order = 8, .alpha = kAlpha, .grid = {80, 80, 80}};
  }

  double pairs(const Nonbonded& of) const {  // [K]
    ClusterPairs sum(of, true, Precision::kDouble);
    Vectors f = Vectors::Zero(3, x.cols());
    sum.add_forces(x, box, f);
    return sum.energy() / kBoltzmann;
  }
};

TEST(PublishedWater, HasTheDispersionEnergy) {
  Water water;
  water.nb.charge.setZero();
  EXPECT_NEAR(water.pairs(water.nb), 9.95387e4, 0.05);
}

// OpenMM's convention is taut's: its mean is over an atom with itself, too, and over hydrogens.
TEST(PublishedWater, HasTheLongRangeCorrection) {
  const Water water;
  const double convention = (300.0 / 301) * (101.0 / 100);
  EXPECT_NEAR(dispersion_coefficient(water.nb) / water.box.volume() / kBoltzmann / convention, -8.23715e2,
              5e-4);
}

TEST(PublishedWater, HasTheEnergyOfRealSpace) {
  Water water;
  water.nb.epsilon.setZero();
  EXPECT_NEAR(water.pairs(water.nb), -5.58889e5, 0.5);
}

// The mesh has all waves; those it has and they have not are summed one by one.
TEST(PublishedWater, HasTheEnergiesOfWavesAndOfWhatTheyCountTooMuch) {
  const Water water;
  const Eigen::VectorXd& q = water.nb.charge;
  const double self = -kCoulomb * kAlpha / std::sqrt(pi) * q.squaredNorm() / kBoltzmann;
  EXPECT_NEAR(self, -2.84469e6, 5);
  double within = 0;
  for (const auto& e : water.nb.exceptions) {
    const double r = (water.x.col(e.i) - water.x.col(e.j)).norm();
    within -= kCoulomb * q[e.i] * q[e.j] * std::erf(kAlpha * r) / r / kBoltzmann;
  }
  EXPECT_NEAR(within, 2.80999e6, 5);

  double beyond = 0;
  constexpr int kMost = 12;
  for (int a = -kMost; a <= kMost; ++a)
    for (int b = -kMost; b <= kMost; ++b)
      for (int c = -kMost; c <= kMost; ++c) {
        const Vec3 k(a, b, c);
        if (k.squaredNorm() < 27) continue;
        std::complex<double> S = 0;
        for (int i = 0; i < 300; ++i) S += std::polar(q[i], 2 * pi / kEdge * k.dot(water.x.col(i)));
        const double m2 = k.squaredNorm() / (kEdge * kEdge);
        beyond += kCoulomb * std::exp(-pi * pi * m2 / (kAlpha * kAlpha)) /
                  (2 * pi * std::pow(kEdge, 3) * m2) * std::norm(S) / kBoltzmann;
      }
  EXPECT_NEAR(beyond, 7.889, 1e-3);

  Pme pme(water.nb, Precision::kDouble);
  pme.set_box(water.box);
  Vectors f = Vectors::Zero(3, 300);
  EXPECT_NEAR(pme.add_forces(water.x, f) / kBoltzmann - self - within - beyond, 6.27009e3, 0.01);
}

}  // namespace
}  // namespace taut::ewald_water_tests
