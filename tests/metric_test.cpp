// Fixman's potential: ½kT ln det A, its gradient, its virial, and what it does to the statistics of chains.

#include <Eigen/LU>
#include <cmath>

#include "base/random.hpp"
#include "constraints/metric_potential.hpp"
#include "force_checks.hpp"
#include "named_scene.hpp"
#include "scene_text.hpp"
#include "simulation/metric_field.hpp"
#include "simulation/simulation.hpp"
#include "systems/openmm/import.hpp"

namespace taut::metric_tests {
namespace {

using testing::HasSubstr;

struct Shape {
  const char* name;
  std::vector<double> mass;
  std::vector<std::array<int, 2>> bonds;
};
std::ostream& operator<<(std::ostream& out, const Shape& shape) {
  return out << shape.name;
}

const Shape kShapes[] = {
    {"Chain", {1, 2, 3, 4, 5, 6}, {{0, 1}, {2, 1}, {2, 3}, {3, 4}, {5, 4}}},
    {"Star", {1, 2, 3, 4, 5}, {{0, 1}, {0, 2}, {3, 0}, {0, 4}}},
    {"Ring", {1, 2, 3, 4, 5, 6, 7}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 0}}},
    {"Braced", {1, 2, 3, 4}, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}},
    {"Anchored", {0, 2, 3, 0}, {{0, 1}, {1, 2}, {2, 3}}}};

class EveryShape : public testing::TestWithParam<Shape> {
 protected:
  void SetUp() override {
    const auto& [name, mass, bonds] = GetParam();
    Random random(7);
    x = Vectors(3, mass.size());
    for (auto column : x.colwise()) column = 0.3 * random.normal_vector();
    std::vector<RigidBond> rigid;
    for (const auto& [i, j] : bonds) rigid.push_back({i, j, (x.col(i) - x.col(j)).norm()});
    sys = make_system(Eigen::Map<const Eigen::VectorXd>(mass.data(), std::ssize(mass)), rigid);
  }
  // ½ ln det of J M⁻¹ Jᵀ as a full matrix.
  double plainly(const Vectors& at) const {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sys.bond_count(), 3 * sys.atoms());
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      J.block<1, 3>(k, 3 * i) = -(at.col(j) - at.col(i)).transpose();
      J.block<1, 3>(k, 3 * j) = (at.col(j) - at.col(i)).transpose();
    }
    const Eigen::VectorXd inv_mass = sys.inv_mass.transpose().replicate(3, 1).reshaped();
    return 0.5 * std::log((J * inv_mass.asDiagonal() * J.transpose()).determinant());
  }

  System sys;
  Vectors x;
};

TEST_P(EveryShape, IsHalfTheLogarithmOfTheDeterminantAndItsForcesAreItsSlope) {
  MetricPotential metric(sys);
  const double kT = 2.5;
  Vectors f = Vectors::Zero(3, x.cols());
  EXPECT_NEAR(metric.add_forces(x, kT, f), kT * plainly(x), 1e-11);
  for (int a = 0; a < x.cols(); ++a)
    for (int d = 0; d < 3; ++d) {
      Vectors up = x, down = x;
      up(d, a) += 1e-5, down(d, a) -= 1e-5;
      EXPECT_NEAR(f(d, a), -kT * (plainly(up) - plainly(down)) / 2e-5, 1e-6 * f.norm()) << a << " " << d;
    }
}

TEST_P(EveryShape, CountsInThePressureByItsSlopeWithTheStrain) {
  Terms terms;
  terms.own.push_back(std::make_shared<MetricField>(sys, 2.5));
  const Box box{Vec3(5, 5, 5)};
  ForceField forces(sys, box, terms);
  State s{x, {}, {}, 0, box};
  ForceField::Evaluation evaluation;
  forces.evaluate(sys, s, evaluation);
  const Eigen::Matrix3d virial = forces.virial(s, evaluation);
  for (int d = 0; d < 3; ++d) {
    Vectors wide = x, narrow = x;
    wide.row(d) *= 1 + 1e-6, narrow.row(d) *= 1 - 1e-6;
    EXPECT_NEAR(virial(d, d), -2.5 * (plainly(wide) - plainly(narrow)) / 2e-6, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryShape, testing::ValuesIn(kShapes),
                         [](const auto& of) { return std::string(of.param.name); });

// ⟨c²⟩ of the cosine between neighbouring bonds, over a run and its chains.
double mean_square_cosine(Simulation& simulation, int beads) {
  double sum = 0, samples = 0;
  simulation.run({}, [&](long step) {
    if (step < 400 || step % 10 != 0) return;
    const Vectors& x = simulation.state().x;
    for (int a = 0; a + beads <= x.cols(); a += beads)
      for (int b = a; b < a + beads - 2; ++b) {
        const Vec3 u = x.col(b + 1) - x.col(b), w = x.col(b + 2) - x.col(b + 1);
        sum += std::pow(u.dot(w), 2), ++samples;
      }
  });
  return sum / samples;
}

const std::vector<std::string> kSampled = {"build.chains=1000", "run.thermostat=\"langevin\"",
                                           "run.steps=1500",    "run.dt_fs=50",
                                           "run.log_every=500", "run.friction_per_ps=1"};

// Rigid bonds make ⟨c²⟩ 0.32102; without their weight the angle is free, ⟨c²⟩ = ⅓. Trimers are drawn with the
// weight, so that the potential has to take it out.
TEST(MetricCorrection, TrimersBendFreely) {
  std::vector<std::string> with = kSampled;
  with.emplace_back("run.metric_correction=true");
  Simulation corrected(scene_of("trimer", with)), rigid(scene_of("trimer", kSampled));
  EXPECT_NEAR(mean_square_cosine(rigid, 3), 0.32102, 0.005);
  EXPECT_NEAR(mean_square_cosine(corrected, 3), 1.0 / 3, 0.005);
}

TEST(MetricCorrection, KeepsTheEnergy) {
  Simulation chain(scene_of("freely_jointed", {"run.metric_correction=true", "run.temperature_k=120",
                                               "run.dt_fs=2", "run.steps=500", "run.log_every=50"}));
  double first = 0, most = 0, potential = 0;
  chain.run([&](const Record& r) {
    if (r.step == 0) first = r.total(), potential = r.potential;
    most = std::max(most, std::abs(r.total() - first));
    EXPECT_NE(r.potential, 0);
  });
  EXPECT_LT(most, 1e-4 * std::abs(first));
  EXPECT_TRUE(chain.scene().closed());
  EXPECT_FALSE(chain.runs_foreign_code());
}

TEST(MetricCorrection, IsRefusedWhereItHasNoMeaning) {
  const auto said = [](const std::vector<std::string>& overrides) -> std::string {
    return error_message([&] { Simulation made(scene_of("trimer", overrides)); });
  };
  EXPECT_THAT(said({"run.metric_correction=true", "run.temperature_k=0"}),
              HasSubstr("run.metric_correction: needs a run.temperature_k above 0"));
  EXPECT_THAT(said({"run.metric_correction=true", "method.name=\"penalty\""}),
              HasSubstr("those of method.name = \"penalty\" are springs"));
  EXPECT_THROW(openmm_input(scene_of("trimer", {"run.metric_correction=true"})), InputError);
}

}  // namespace
}  // namespace taut::metric_tests
