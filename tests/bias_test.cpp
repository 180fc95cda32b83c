// Biases of distances, angles, torsions and radii of gyration: energy, forces and virial, and geometries in which they
// have no direction.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "force_checks.hpp"

namespace taut::bias_tests {
namespace {

using Variable = Bias::Variable;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;

constexpr int kAtoms = 10;
const std::vector<std::vector<int>> kGroups = {{0, 1, 2}, {3, 4}, {5}, {6, 7, 8, 9}};

System system_of_ten() {
  Eigen::VectorXd mass(kAtoms);
  mass << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10;
  return make_system(mass, {});
}

// Four loose groups about the corners of a square, which is folded.
Vectors ten_atoms(unsigned seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal(0, 0.08);
  const Vec3 corner[] = {{0, 0, 0.2}, {0.6, 0.1, 0}, {0.7, 0.7, 0.1}, {0.1, 0.8, 0.5}};
  Vectors x(3, kAtoms);
  for (std::size_t g = 0; g < kGroups.size(); ++g)
    for (const int a : kGroups[g]) x.col(a) = corner[g] + Vec3(normal(rng), normal(rng), normal(rng));
  return x;
}

Bias bias_of(Variable variable) {
  Bias bias{.name = "test", .variable = variable};
  for (int g = 0; g < groups_of(variable); ++g)
    bias.groups.push_back(make_group(system_of_ten(), kGroups[variable == Variable::kGyration ? 3 : g]));
  if (variable == Variable::kComponent) bias.along = Vec3(1, -2, 2) / 3;
  return bias;
}

constexpr Variable kAll[] = {Variable::kDistance, Variable::kComponent, Variable::kAngle, Variable::kTorsion,
                             Variable::kGyration};

// A harmonic restraint, each wall, and a pull, none of which is at rest.
std::vector<Bias> laws_of(Variable variable) {
  Bias held = bias_of(variable);
  held.k = 300;
  const double now = value_of(held, {}, ten_atoms(1));
  const bool goes_round = variable == Variable::kTorsion;
  std::vector<Bias> laws(3, held);
  laws[0].lower = laws[0].upper = now + 0.1;
  laws[1].lower = now + 0.05, laws[1].upper = goes_round ? now + 1 : kInf;
  laws[2].lower = goes_round ? now - 1 : -kInf, laws[2].upper = now - 0.05;
  if (goes_round) return laws;
  Bias pull = bias_of(variable);
  pull.force = -40;
  laws.push_back(pull);
  return laws;
}

// ξ by other formulas than the engine's: cosines, and R_g² = ½ ΣΣ w_i w_j r_ij².
double plain_value(const Bias& bias, const Vectors& x) {
  std::vector<Vec3> c;
  for (const BiasGroup& group : bias.groups) {
    double mass = 0;
    Vec3 sum = Vec3::Zero();
    for (const int a : group.atoms) mass += a + 1, sum += (a + 1) * x.col(a);
    c.push_back(sum / mass);
  }
  switch (bias.variable) {
    case Variable::kDistance:
      return (c[1] - c[0]).norm();
    case Variable::kComponent:
      return (c[1] - c[0]).dot(bias.along);
    case Variable::kAngle:
      return std::acos((c[0] - c[1]).normalized().dot((c[2] - c[1]).normalized()));
    case Variable::kTorsion: {
      const Vec3 b1 = c[1] - c[0], b2 = c[2] - c[1], b3 = c[3] - c[2];
      const double angle = std::acos(b1.cross(b2).normalized().dot(b2.cross(b3).normalized()));
      return b1.dot(b2.cross(b3)) > 0 ? angle : -angle;
    }
    case Variable::kGyration:
      double squares = 0, mass = 0;
      for (const int a : bias.groups[0].atoms) mass += a + 1;
      for (const int a : bias.groups[0].atoms)
        for (const int b : bias.groups[0].atoms)
          squares += 0.5 * (a + 1) * (b + 1) / (mass * mass) * (x.col(a) - x.col(b)).squaredNorm();
      return std::sqrt(squares);
  }
  return NAN;
}

double plain_energy(const Bias& bias, double value) {
  if (bias.variable == Variable::kTorsion)
    while (value > 0.5 * (bias.lower + bias.upper) + kPi) value -= 2 * kPi;
  if (bias.variable == Variable::kTorsion)
    while (value < 0.5 * (bias.lower + bias.upper) - kPi) value += 2 * kPi;
  const double above = std::max(value - bias.upper, 0.0), below = std::max(bias.lower - value, 0.0);
  return (bias.k > 0 ? 0.5 * bias.k * (above * above + below * below) : 0) - bias.force * value;
}

struct Bench {
  System sys = system_of_ten();
  Box box;
  ForceField forces;

  explicit Bench(Bias bias, const Box& in = {}) : box(in), forces(sys, box, terms_of(std::move(bias))) {}
  static Terms terms_of(Bias bias) {
    Terms terms;
    terms.biases = {std::move(bias)};
    return terms;
  }
  Evaluated at(const Vectors& x, const Box& in) {
    State s{x, {}, {}, 0, in};
    const double energy = forces.evaluate_energy(sys, s);
    return {energy, s.f};
  }
  Evaluated at(const Vectors& x) { return at(x, box); }
  Eigen::Matrix3d virial_at(const Vectors& x) {
    State s{x, {}, {}, 0, box};
    ForceField::Evaluation evaluation;
    forces.evaluate(sys, s, evaluation);
    return forces.virial(s, evaluation);
  }
};

TEST(Bias, HasThePlainEnergyWhoseSlopeIsTheForce) {
  for (const Variable variable : kAll)
    for (const Bias& bias : laws_of(variable)) {
      const std::string what =
          fmt::format("{} k {} walls {} {}", name_of(variable), bias.k, bias.lower, bias.upper);
      const Vectors x = ten_atoms(1);
      const Evaluated ours = Bench(bias).at(x);
      EXPECT_NEAR(ours.energy, plain_energy(bias, plain_value(bias, x)), 1e-12 * std::abs(ours.energy))
          << what;
      EXPECT_GT(ours.f.norm(), 1) << what;
      EXPECT_LT(ours.f.rowwise().sum().norm(), 1e-12 * ours.f.norm()) << what << ": momentum";
      const double step = 1e-5;
      for (int a = 0; a < kAtoms; ++a)
        for (int d = 0; d < 3; ++d) {
          Vectors up = x, down = x;
          up(d, a) += step, down(d, a) -= step;
          const double slope =
              (plain_energy(bias, plain_value(bias, up)) - plain_energy(bias, plain_value(bias, down))) /
              (2 * step);
          EXPECT_NEAR(ours.f(d, a), -slope, 1e-7 * ours.f.cwiseAbs().maxCoeff()) << what << " atom " << a;
        }
    }
}

// Whole groups are moved by vectors of the box, and nothing changes; the energy's slope under strain is the virial.
TEST(Bias, TakesNearestImagesOfCentresAndHasTheVirialOfTheStrain) {
  for (const Box& box : {Box{Vec3(2.2, 2.4, 2.3)}, Box{Vec3(2.2, 2.4, 2.3), Vec3(0.7, -0.6, 0.9)}})
    for (const Variable variable : kAll)
      for (Bias bias : laws_of(variable)) {
        if (variable == Variable::kComponent) {
          bias.along = Vec3(0, 0, 1);
          bias.lower = bias.lower == -kInf ? -kInf : 0.2;
          bias.upper = bias.upper == kInf ? kInf : 0.25;
        }
        Vectors x = ten_atoms(1);
        Bench bench(bias, box);
        const Evaluated whole = bench.at(x);
        EXPECT_NEAR(whole.energy, Bench(bias).at(x).energy, 1e-12 * std::abs(whole.energy));
        for (const int a : kGroups[1]) x.col(a) += box.lattice_vector({1, -2, 3});
        for (const int a : kGroups[3]) x.col(a) -= box.lattice_vector({1, 1, 0});
        const Evaluated apart = bench.at(x);
        EXPECT_NEAR(apart.energy, whole.energy, 1e-11 * std::abs(whole.energy));
        EXPECT_LE((apart.f - whole.f).norm(), 1e-11 * whole.f.norm());
        const Eigen::Matrix3d virial = bench.virial_at(x);
        for (int d = 0; d < 3; ++d) {
          const auto strained = [&](double by) {
            Vectors y = x;
            y.row(d) *= 1 + by;
            Vec3 scale = Vec3::Ones();
            scale[d] += by;
            return bench.at(y, box.scaled(scale)).energy;
          };
          EXPECT_NEAR(virial(d, d), -(strained(1e-6) - strained(-1e-6)) / 2e-6, 1e-6 * virial.norm())
              << name_of(variable);
        }
      }
}

TEST(Bias, CountsATorsionFromTheMiddleOfItsWalls) {
  Bias bias = bias_of(Variable::kTorsion);
  const Vectors x = ten_atoms(1);
  const double now = value_of(bias, {}, x);
  bias.k = 100;
  for (const double centre : {now + kPi - 0.01, now - kPi + 0.01, now + 2 * kPi - 0.3, now - 4 * kPi + 0.3}) {
    bias.lower = bias.upper = centre;
    const double away = std::remainder(now - centre, 2 * kPi);
    BiasForces found;
    Vectors f = Vectors::Zero(3, kAtoms);
    add_biases({bias}, {x, {}, {}, 0, {}}, f, found);
    EXPECT_NEAR(found.energy, 50 * away * away, 1e-9);
    EXPECT_NEAR(found.readings[0].value, centre + away, 1e-12);
    EXPECT_NEAR(found.readings[0].force, -100 * away, 1e-9);
  }
}

// Where centres coincide or lie in a line a force has no direction: there is none, and it is said.
TEST(Bias, ActsNotWhereItHasNoDirectionAndSaysSo) {
  const auto evaluated = [](Bias bias, const Vectors& x) {
    for (BiasGroup& group : bias.groups)
      group.share.assign(group.atoms.size(), 1 / static_cast<double>(group.atoms.size()));
    BiasForces found;
    Vectors f = Vectors::Zero(3, x.cols());
    add_biases({bias}, {x, {}, {}, 0, {}}, f, found);
    EXPECT_TRUE(f.isZero(0));
    EXPECT_TRUE(std::isfinite(found.energy) && found.virial.isZero(0));
    return found.readings[0];
  };
  const auto atoms = [](int count) {
    std::vector<BiasGroup> groups;
    for (int a = 0; a < count; ++a) groups.push_back({{a}, {1}});
    return groups;
  };
  const Vectors line = columns({{0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {1, 0, 0}});
  const Vectors point = Vectors::Constant(3, 4, 0.3);
  Bias bias{.name = "b", .groups = atoms(2), .k = 10, .lower = 1, .upper = 1};
  EXPECT_TRUE(evaluated(bias, point).lost);
  bias = {.name = "b", .variable = Variable::kAngle, .groups = atoms(3), .k = 10, .lower = 1, .upper = 1};
  EXPECT_TRUE(evaluated(bias, line).lost);
  EXPECT_TRUE(evaluated(bias, point).lost);
  EXPECT_NEAR(evaluated(bias, line).value, kPi, 1e-9);
  // At rest nothing is lost.
  const BiasReading straight = evaluated(
      {.name = "b", .variable = Variable::kAngle, .groups = atoms(3), .k = 10, .lower = 0, .upper = kPi},
      line);
  EXPECT_FALSE(straight.lost);
  bias = {.name = "b", .variable = Variable::kTorsion, .groups = atoms(4), .k = 10, .lower = 1, .upper = 1};
  EXPECT_TRUE(evaluated(bias, line).lost);
  EXPECT_TRUE(evaluated(bias, point).lost);
  bias = {.name = "b",
          .variable = Variable::kGyration,
          .groups = {{{0, 1, 2}, {}}},
          .k = 10,
          .lower = 1,
          .upper = 1};
  EXPECT_TRUE(evaluated(bias, point).lost);
}

}  // namespace
}  // namespace taut::bias_tests
