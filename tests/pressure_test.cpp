// Virial and pressure, against numerical derivatives of the energy by the box's strain.

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "constraints/methods/penalty.hpp"
#include "force_checks.hpp"
#include "md/observables.hpp"
#include "pressure_of.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::pressure_tests {
namespace {

constexpr double kEdge = 2;  // [nm]

// Atoms not too near each other, none of them wrapped.
Vectors spread(int atoms, std::uint64_t seed) {
  Random random(seed);
  const Box box{{kEdge, kEdge, kEdge}};
  Vectors x(3, atoms);
  for (int a = 0; a < atoms;) {
    x.col(a) = 1.5 * kEdge * random.uniform_vector();
    bool near = false;
    for (int b = 0; b < a; ++b) near |= box.nearest_image(x.col(a) - x.col(b)).norm() < 0.22;
    if (!near) ++a;
  }
  return x;
}

// Ξ = −dE/dε, box and positions strained by 1 + ε, in every direction.
void expect_virial_is_the_slope(const Terms& terms, const Vectors& x, bool box = true) {
  const Box edges = box ? Box{Vec3::Constant(kEdge)} : Box{};
  Bench bench(static_cast<int>(x.cols()), terms, edges);
  const Eigen::Matrix3d virial = bench.virial_at(x);
  EXPECT_GT(virial.norm(), 1e-3);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      if (box && a > b) continue;  // it stays in reduced form
      const auto strained = [&](double by) {
        Eigen::Matrix3d strain = Eigen::Matrix3d::Identity();
        strain(a, b) += by;
        return evaluate(terms, strain * x, edges.periodic() ? Box::of(strain * edges.vectors()) : Box{})
            .energy;
      };
      const double step = 1e-6, slope = (strained(step) - strained(-step)) / (2 * step);
      EXPECT_NEAR(virial(a, b), -slope, 1e-6 * virial.norm()) << a << b;
      EXPECT_NEAR(virial(b, a), virial(a, b), 1e-9 * virial.norm()) << a << b;
    }
}

Nonbonded charges_and_spheres(int atoms) {
  Nonbonded nb;
  nb.charge = Eigen::VectorXd::LinSpaced(atoms, -0.5, 0.5);
  nb.sigma = Eigen::VectorXd::LinSpaced(atoms, 0.2, 0.35);
  nb.epsilon = Eigen::VectorXd::LinSpaced(atoms, 0.3, 0.9);
  nb.cutoff = 0.9;
  nb.switch_distance = 0.7;
  return nb;
}

TEST(Virial, OfPairs) {
  Terms boxed, apart;
  boxed.nonbonded = apart.nonbonded = charges_and_spheres(60);
  boxed.nonbonded->dispersion_correction = true;
  apart.nonbonded->cutoff.reset();
  apart.nonbonded->switch_distance.reset();
  expect_virial_is_the_slope(boxed, spread(60, 1));
  expect_virial_is_the_slope(apart, spread(60, 2), false);
  expect_virial_is_the_slope({.wca = Wca{.sigma = 0.5, .epsilon = 1, .exclusions = {}}}, spread(60, 3));
}

TEST(Virial, OfWhatActsWithinMolecules) {
  const Vectors four = columns({{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.4, 0.1}, {0.5, 0.6, 0.4}});
  Terms exceptions, terms;
  exceptions.nonbonded = charges_and_spheres(4);
  exceptions.nonbonded->epsilon.setZero();
  exceptions.nonbonded->charge.setZero();
  exceptions.nonbonded->exceptions = {{0, 1, 0.2, 0.3, 0.5}, {1, 2, -0.1, 0.2, 0.1}};
  expect_virial_is_the_slope(exceptions, four, false);
  terms.bonds = {{0, 1, 0.25, 1000}};
  terms.fene = {{1, 2, 30, 1.5}};
  terms.angles = {{0, 1, 2, 1.5, 100}};
  terms.rb_torsions = {{0, 1, 2, 3, {9, 12, 1, -30, 2, 1}}};
  terms.torsions = {{0, 1, 2, 3, 3, 0.1, 5}};
  expect_virial_is_the_slope(terms, four, false);
}

// A conductor's reaction field, whose force ends at zero: a slope across a kink is nobody's.
Scene water(std::vector<std::string> more = {}) {
  std::vector<std::string> keys = {"forcefield.switch_nm=0.75", "forcefield.rf_dielectric=1e9", "run.dt_fs=1",
                                   "run.steps=20"};
  keys.insert(keys.end(), more.begin(), more.end());
  return read_scene(find_scene("water"), keys);
}

// The centres of molecules of three and the box scaled by s, the molecules as they are.
double energy_scaled(const Scene& scene, const Vectors& x, double s) {
  const System& sys = scene.system;
  State state{x, {}, {}, 0, scene.start.box.scaled(Vec3::Constant(s))};
  for (int o = 0; o < sys.atoms(); o += 3) {
    const Vec3 centre = x.middleCols<3>(o) * sys.mass.segment<3>(o) / sys.mass.segment<3>(o).sum();
    state.x.middleCols<3>(o).colwise() += (s - 1) * centre;
  }
  ForceField forces(sys, state.box, scene.terms);
  return forces.evaluate_energy(sys, state);
}

// For rigid molecules the constraint forces turn the pressure of the atoms into that of the molecules,
//     P = (2K_translation − dE/d ln s)/(3V),  s the scale of box and centres, at every instant.
double molecular_pressure(const Scene& scene, const State& state) {
  const System& sys = scene.system;
  const double step = 1e-6;
  const double slope =
      (energy_scaled(scene, state.x, 1 + step) - energy_scaled(scene, state.x, 1 - step)) / (2 * step);
  double twice_kinetic = 0;
  for (int o = 0; o < sys.atoms(); o += 3)
    twice_kinetic +=
        (state.v.middleCols<3>(o) * sys.mass.segment<3>(o)).squaredNorm() / sys.mass.segment<3>(o).sum();
  return kBarPerUnit * (twice_kinetic - slope) / (3 * scene.start.box.volume());
}

double atomic_pressure(const Scene& scene, const State& state) {
  ForceField forces(scene.system, state.box, scene.terms);
  return tests::pressure_of(scene.system, forces, state).trace() / 3;
}

TEST(Pressure, OfRigidWatersIsThatOfTheirCentresAtTheStartAndLater) {
  Simulation simulation(water());
  const Scene& scene = simulation.scene();
  EXPECT_NEAR(atomic_pressure(scene, simulation.state()), molecular_pressure(scene, simulation.state()),
              0.02);
  simulation.run([](const Record&) {});
  const double pressure = atomic_pressure(scene, simulation.state());
  EXPECT_NEAR(pressure, molecular_pressure(scene, simulation.state()), 0.02);
  EXPECT_GT(std::abs(pressure), 1);
}

TEST(Pressure, IsTheSameForEveryMethodThatHoldsTheBonds) {
  const auto after_a_while = [](const std::string& method) {
    Simulation simulation(water({"method.name=" + method}));
    simulation.run([](const Record&) {});
    return atomic_pressure(simulation.scene(), simulation.state());
  };
  const double newton = after_a_while("newton");
  for (const char* method : {"rattle", "settle", "feedforward", "baumgarte"})
    EXPECT_NEAR(after_a_while(method), newton, 5) << method;
}

TEST(Pressure, InMixedPrecision) {
  const Scene scene = water(), mixed = water({"forcefield.precision=mixed"});
  EXPECT_NEAR(atomic_pressure(mixed, mixed.start), atomic_pressure(scene, scene.start), 0.5);
}

// A penalty's springs press as harmonic bonds of the same stiffness do.
TEST(Pressure, OfPenaltySpringsIsThatOfHarmonicBonds) {
  const Box box{{kEdge, kEdge, kEdge}};
  const Eigen::VectorXd mass = Eigen::VectorXd::Ones(2);
  const System rigid = make_system(mass, {{0, 1, 0.3}}), soft = make_system(mass, {});
  State s{columns({{0, 0, 0}, {0.2, 0.2, 0.2}}), columns({{0, 1, 0}, {1, 0, 0}}), Vectors::Zero(3, 2), 0,
          box};
  Penalty penalty(rigid, {.k = 500}, 1e-3);
  EXPECT_TRUE(penalty.add_forces(rigid, Push::at_start(1e-3), s).converged());
  ForceField none(rigid, box, {}), bond(soft, box, {.bonds = {{0, 1, 0.3, 500}}});
  const Eigen::Matrix3d pressure = tests::pressure_of(rigid, none, s, &penalty.lambda());
  EXPECT_LT((pressure - tests::pressure_of(soft, bond, s)).norm(), 1e-9);
}

}  // namespace
}  // namespace taut::pressure_tests
