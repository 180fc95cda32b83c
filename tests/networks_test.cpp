// Molecules bonded around the box to their own image, against closed forms and slopes of their energy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/statistics.hpp"
#include "error_message.hpp"
#include "lammps_files.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "pressure_of.hpp"
#include "scene_energy.hpp"
#include "simulation/minimise.hpp"
#include "simulation/simulation.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/start_file.hpp"

namespace taut::networks_tests {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

// A zigzag of n atoms around the box along x, with arms of d, and `more` atoms elsewhere.
struct Ring {
  Scene scene;
  double d;

  Ring(int n, double d_, const Box& box, bool rigid, int more = 0) : d(d_) {
    std::vector<RigidBond> bonds;
    State& s = scene.start;
    s.box = box;
    s.x = Vectors::Zero(3, n + more);
    s.v = s.f = s.x;
    const double step = box.edge.x() / n, height = std::sqrt(d * d - step * step);
    for (int a = 0; a < n; ++a) {
      const int next = (a + 1) % n, after = (a + 2) % n;
      s.x.col(a) = Vec3(step * a + 0.01, 0.3 + (a % 2 == 1 ? height : 0), 0.4);
      if (rigid)
        bonds.push_back({a, next, d});
      else
        scene.terms.bonds.push_back({a, next, d, 2000});
      scene.terms.angles.push_back({a, next, after, 2.0, 80});
    }
    for (int a = 0; a < more; ++a) s.x.col(n + a) = Vec3(0.7 * a, 0.9 * a, 1.1 * a);
    scene.system = make_system(Eigen::VectorXd::Constant(n + more, 10), bonds);
    scene.method = default_options("newton");
    scene.names = guessed_names(scene.system, scene.terms);
    settle();
  }

  void settle() { make_whole(tethers(scene.system, scene.terms), scene.start, scene.system); }
};

const Box kBox{{2, 1.5, 1.4}};

// E = n ½k(θ − θ₀)², sin ½θ = L/nd, and P_xx V = −L dE/dL, whatever images the atoms are given as.
TEST(Networks, ARigidRingAroundTheBoxPullsAtIt) {
  const int n = 8;
  Ring ring(n, 0.28, kBox, true);
  const double L = kBox.edge.x(), half = std::asin(L / (n * ring.d));
  const double slope = n * 80 * (2 * half - 2.0) * 2 / (n * ring.d * std::cos(half));
  const double right = -slope / (1.5 * 1.4) * kBarPerUnit;
  for (const Vec3& cell : {Vec3(0, 0, 0), Vec3(-1, 2, 0), Vec3(1, 0, -3)}) {
    Ring moved = ring;
    moved.scene.start.x.col(3) += kBox.lattice_vector(cell);
    moved.settle();
    EXPECT_NEAR(energy_of(moved.scene), n * 40 * std::pow(2 * half - 2.0, 2), 1e-9);
    ForceField forces(moved.scene.system, kBox, moved.scene.terms);
    const Eigen::Matrix3d P = tests::pressure_of(moved.scene.system, forces, moved.scene.start);
    EXPECT_NEAR(P(0, 0), right, 1e-9 * std::abs(right));
    EXPECT_LT(bond_errors(moved.scene.system, moved.scene.start.x).max, 1e-12);
  }
}

// Forces are −dE/dx, and the virial −dE/dstrain, of all that acts along molecules and of PME's exceptions.
TEST(Networks, ForcesAndVirialAreSlopesOfTheEnergy) {
  Ring ring(8, 0.28, Box{{2, 1.9, 1.8}, {0.3, -0.2, 0.4}}, false, 2);
  Terms& terms = ring.scene.terms;
  Nonbonded& nb = terms.nonbonded.emplace();
  const int n = 10;
  nb.charge = Eigen::VectorXd::Zero(n);
  nb.sigma = Eigen::VectorXd::Constant(n, 0.2);
  nb.epsilon = Eigen::VectorXd::Constant(n, 0.4);
  nb.cutoff = 0.85;
  nb.pme.emplace();
  for (int a = 0; a < 8; ++a) {
    nb.charge[a] = a % 2 == 0 ? 0.4 : -0.4;
    const int b = (a + 1) % 8, c = (a + 2) % 8, d = (a + 3) % 8;
    terms.torsions.push_back({a, b, c, d, 2, 0.3, 5});
    nb.exceptions.push_back({a, b, 0, 1, 0});
    nb.exceptions.push_back({a, c, 0, 1, 0});
    nb.exceptions.push_back({a, d, 0.08, 0.2, 0.2});
  }
  State s = ring.scene.start;
  s.x += 0.03 * Vectors::Random(3, n);
  ForceField forces(ring.scene.system, s.box, terms);
  ForceField::Evaluation evaluation;
  forces.evaluate(ring.scene.system, s, evaluation);
  const Vectors f = s.f;
  const Eigen::Matrix3d virial = forces.virial(s, evaluation);
  const double step = 1e-5;
  const auto energy_at = [&](const Vectors& x, const Box& box) {
    State there{x, s.v, s.f, 0, box};
    return forces.evaluate_energy(ring.scene.system, there);
  };
  for (int a : {0, 3, 7, 9})
    for (int k = 0; k < 3; ++k) {
      Vectors up = s.x, down = s.x;
      up(k, a) += step, down(k, a) -= step;
      EXPECT_NEAR(f(k, a), (energy_at(down, s.box) - energy_at(up, s.box)) / (2 * step), 1e-3);
    }
  for (int k = 0; k < 3; ++k) {
    const auto strained = [&](double by) {
      const Vec3 mu = Vec3::Ones() + by * Vec3::Unit(k);
      return energy_at(mu.asDiagonal() * s.x, s.box.scaled(mu));
    };
    EXPECT_NEAR(virial(k, k), (strained(-step) - strained(step)) / (2 * step), 1e-3 + 1e-4 * virial.norm());
  }
}

// Anchors are pressed on by those they are bonded to around the box as by those beside them: half the ring further, all is alike.
TEST(Networks, AnchorsThatAreBondedAroundTheBoxPressAsAnyOthers) {
  for (const bool charged : {false, true}) {
    const auto virial_with = [&](std::vector<int> anchors) {
      Ring ring(8, 0.28, Box{{2, 1.9, 1.8}}, false);
      Terms& terms = ring.scene.terms;
      for (int a = 0; a < 8; ++a) terms.fene.push_back({a, (a + 1) % 8, 1000, 0.5});
      if (charged) {
        Nonbonded& nb = terms.nonbonded.emplace();
        nb.charge = Eigen::VectorXd::Zero(8);
        nb.sigma = Eigen::VectorXd::Constant(8, 0.2), nb.epsilon = Eigen::VectorXd::Constant(8, 0.4);
        nb.cutoff = 0.85;
        nb.pme.emplace().grid = {32, 32, 32};
        for (int a = 0; a < 8; ++a) {
          nb.charge[a] = a % 2 == 0 ? 0.4 : -0.4;
          nb.exceptions.push_back({a, (a + 1) % 8, -0.08, 0.2, 0.2});
          nb.exceptions.push_back({a, (a + 2) % 8, 0, 1, 0});
        }
      }
      Eigen::VectorXd mass = Eigen::VectorXd::Constant(8, 10);
      for (const int a : anchors) mass[a] = 0;
      ring.scene.system = make_system(mass, {});
      ring.settle();
      State s = ring.scene.start;
      ForceField forces(ring.scene.system, s.box, terms);
      ForceField::Evaluation evaluation;
      forces.evaluate(ring.scene.system, s, evaluation);
      return forces.virial(s, evaluation);
    };
    const Eigen::Matrix3d beside = virial_with({3, 4, 5});
    EXPECT_GT(std::abs(beside(0, 0) - virial_with({3})(0, 0)), 1) << "what is among anchors counts nothing";
    EXPECT_LT((virial_with({7, 0, 1}) - beside).norm(), 1e-6 * beside.norm()) << charged;
  }
}

// Diamond of rigid bonds, with a bead in the middle of each link, pressed to 0.8 of its taut volume, in repelling beads and
// springs of angles. At rest in a minimum the pressure is −dE/dV of minima.
TEST(Networks, ARigidDiamondsPressureIsMinusTheSlopeOfItsEnergy) {
  constexpr double d = 0.3, k = 0.928;
  const double edge = k * 8 * d / std::sqrt(3);
  const std::array<Vec3, 4> fcc = {Vec3(0, 0, 0), {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}};
  const std::array<Vec3, 4> arms = {Vec3(1, 1, 1), {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  Scene scene;
  State& s = scene.start;
  s.box.edge.setConstant(edge);
  std::vector<Vec3> places;
  for (const Vec3& p : fcc) places.push_back(edge * p);
  for (const Vec3& p : fcc) places.push_back(edge * (p + Vec3::Constant(0.25)));
  std::vector<RigidBond> bonds;
  std::vector<std::vector<int>> beads_at(8);
  for (int node = 0; node < 4; ++node)
    for (const Vec3& arm : arms) {
      const Vec3 end = places[node] + edge / 4 * arm;
      for (int other = 4; other < 8; ++other)
        if (s.box.nearest_image(places[other] - end).norm() < 1e-6) {
          const int bead = static_cast<int>(places.size());
          places.push_back(places[node] + edge / 8 * arm + 0.02 * Vec3(arm.y(), -arm.x(), 0.3));
          bonds.push_back({node, bead, d});
          bonds.push_back({bead, other, d});
          scene.terms.angles.push_back({node, bead, other, 2.4, 20});
          beads_at[node].push_back(bead), beads_at[other].push_back(bead);
        }
    }
  ASSERT_EQ(bonds.size(), 32u);
  for (int node = 0; node < 8; ++node)
    for (int one = 0; one < 4; ++one)
      for (int other = one + 1; other < 4; ++other)
        scene.terms.angles.push_back({beads_at[node][one], node, beads_at[node][other], 1.9, 30});
  scene.terms.wca = Wca{0.26, 2, {}};
  const auto n = static_cast<Eigen::Index>(places.size());
  s.x.resize(3, n);
  for (Eigen::Index a = 0; a < n; ++a) s.x.col(a) = places[static_cast<std::size_t>(a)];
  s.v = s.f = Vectors::Zero(3, n);
  System& sys = scene.system = make_system(Eigen::VectorXd::Constant(n, 10), bonds);
  make_whole(tethers(sys, scene.terms), s, sys);
  EXPECT_EQ(sys.reach[0], Reach::kCluster);
  const auto least = [&](const State& from, double strain) {
    State at = from;
    const Vec3 mu = Vec3::Constant(1 + strain);
    at.x = (1 + strain) * from.x;
    at.box = from.box.scaled(mu);
    System there = sys;
    there.images = at.box;
    ForceField forces(there, at.box, scene.terms);
    Minimised result = minimise(there, forces, {.force = 1e-6, .most_moves = 200000}, at);
    struct Least {
      State at;
      double energy, pressure;
    };
    const Eigen::Matrix3d P = tests::pressure_of(there, forces, at);
    return Least{at, result.energy, P.trace() / 3};
  };
  const auto here = least(s, 0);
  EXPECT_LT(bond_errors(sys, here.at.x).max, 1e-12);
  const double strain = 1e-4, V = here.at.box.volume();
  const auto more = least(here.at, strain), less = least(here.at, -strain);
  const double slope =
      (more.energy - less.energy) / (V * (std::pow(1 + strain, 3) - std::pow(1 - strain, 3)));
  EXPECT_GT(std::abs(here.pressure), 100);
  EXPECT_NEAR(here.pressure, -slope * kBarPerUnit, 1e-3 * std::abs(here.pressure));
}

// Energy and bonds are kept, and the ends agree.
TEST(Networks, MethodsAgreeOnARingThatMoves) {
  Vectors of_newton;
  for (const char* method : {"newton", "rattle", "shake", "feedforward", "baumgarte", "mshake"}) {
    Ring ring(8, 0.28, kBox, true, 3);
    Scene& scene = ring.scene;
    scene.system = make_system(scene.system.mass, [&] {  // a whole molecule beside it, which goes in lanes
      auto bonds = scene.system.bonds;
      bonds.push_back({8, 9, (scene.start.x.col(9) - scene.start.x.col(8)).norm()});
      return bonds;
    }());
    ring.settle();
    EXPECT_EQ(scene.system.reach[8], Reach::kWhole);
    scene.start.v = Vectors::Random(3, 11);
    for (int a = 0; a < 11; ++a) scene.start.v.col(a) = Vec3(std::sin(a), std::cos(2 * a), std::sin(3 * a));
    scene.run.dt_fs = 1, scene.run.steps = 300, scene.run.log_every = 100;
    scene.method = default_options(method);
    Simulation simulation(scene, 1);
    std::vector<double> energies;
    double off = 0;
    simulation.run([&](const Record& r) { energies.push_back(r.total()), off = std::max(off, r.bonds.max); });
    EXPECT_LT(off, 1e-4) << method;
    EXPECT_NEAR(energies.back(), energies.front(), 2e-3 * energies.front()) << method;
    if (of_newton.size() == 0) of_newton = simulation.state().x;
    EXPECT_LT((simulation.state().x - of_newton).cwiseAbs().maxCoeff(), 2e-6) << method;
  }
}

// A phantom ring of n springs of no length around the box, among M atoms that do not meet: the volume has the density
// V^(M+1) exp(−(PV + kV^⅔/2n)/kT).
class NetworksUnderABarostat : public testing::TestWithParam<const char*> {};
TEST_P(NetworksUnderABarostat, HaveTheirVolumes) {
  constexpr int n = 16, M = 20;
  constexpr double k = 400, P = 2.4, T = 300, kT = kBoltzmann * T;
  Ring ring(n, 2.0 / n + 1e-9, Box{{2, 2, 2}}, false, M);
  Scene& scene = ring.scene;
  scene.terms = {};
  for (int a = 0; a < n; ++a) scene.terms.bonds.push_back({a, (a + 1) % n, 0, k});
  ring.settle();
  ASSERT_EQ(scene.system.reach[0], Reach::kMolecule);
  scene.run.dt_fs = 20, scene.run.steps = 100000, scene.run.log_every = 50;
  scene.run.temperature_k = T, scene.run.thermostat = "langevin", scene.run.friction_per_ps = 2;
  scene.run.velocities = "draw";
  scene.run.barostat = GetParam(), scene.run.pressure_bar = P * kBarPerUnit;
  scene.run.compressibility_per_bar = 1 / (3 * P * kBarPerUnit);
  scene.run.barostat_every = 5, scene.run.barostat_ps = 0.5;
  Simulation simulation(scene, 1);
  RunningMean mean, square;
  simulation.run([&](const Record&) {
    const double V = simulation.state().box.volume();
    mean.add(V), square.add(V * V);
  });
  double weights = 0, first = 0, second = 0;
  for (double V = 0.5; V < 40; V += 0.01) {
    const double w =
        std::exp((M + 1) * std::log(V / 8) - (P * (V - 8) + k * std::pow(V, 2.0 / 3) / (2 * n)) / kT);
    weights += w, first += w * V, second += w * V * V;
  }
  const Estimate of_mean = mean.estimate(), of_square = square.estimate();
  EXPECT_LT(of_mean.error, 0.15);
  EXPECT_NEAR(of_mean.value, first / weights, 4 * of_mean.error);
  EXPECT_NEAR(of_square.value, second / weights, 4 * of_square.error);
}
INSTANTIATE_TEST_SUITE_P(All, NetworksUnderABarostat, testing::Values("monte-carlo", "c-rescale"));

// Three rigid pairs around the box, each joined to the next by a spring from its outer end to the far one's, a hair below half
// the box: what is bonded by centres shrinks less than the box.
TEST(Networks, TrialBoxesInWhichASpringReachesOverHalfTheBoxAreRefused) {
  constexpr double d = 0.133, edge = 1.6;
  Scene scene;
  State& s = scene.start;
  s.box.edge = Vec3(2, edge, edge);
  s.x = Vectors::Zero(3, 6);
  s.v = s.f = s.x;
  std::vector<RigidBond> bonds;
  for (int pair = 0; pair < 3; ++pair) {
    s.x(0, 2 * pair) = 2.0 / 3 * pair, s.x(0, 2 * pair + 1) = 2.0 / 3 * pair + d;
    bonds.push_back({2 * pair, 2 * pair + 1, d});
    scene.terms.bonds.push_back({2 * pair, (2 * pair + 3) % 6, 0.7, 1});
  }
  scene.system = make_system(Eigen::VectorXd::Constant(6, 1e6), bonds);
  make_whole(tethers(scene.system, scene.terms), s, scene.system);
  ASSERT_EQ(scene.system.reach[0], Reach::kMolecule);
  scene.method = default_options("newton");
  scene.names = guessed_names(scene.system, scene.terms);
  scene.run.dt_fs = 1, scene.run.steps = 20, scene.run.log_every = 10;
  scene.run.temperature_k = 1, scene.run.thermostat = "langevin";
  scene.run.barostat = "monte-carlo", scene.run.barostat_every = 1, scene.run.pressure_bar = 1e6;
  Simulation simulation(scene, 1);
  const Summary summary = simulation.run({});
  EXPECT_EQ(summary.steps, 20);
  EXPECT_GT(simulation.state().box.volume(), 0.9924 * s.box.volume());
  EXPECT_THAT(summary.doubts, testing::Contains(HasSubstr("over half the box")));
}

TEST(Networks, RefuseABarostatWhereRigidBondsGoAround) {
  Ring ring(8, 0.28, kBox, true);
  ring.scene.run.barostat = "c-rescale", ring.scene.run.temperature_k = 300;
  ring.scene.run.thermostat = "langevin";
  EXPECT_THAT(error_message([&] { Simulation(ring.scene, 1); }),
              HasSubstr("atom 0 is of a cluster of rigid bonds that goes around the box"));
}

TEST(Networks, KeepTheirImagesInFiles) {
  for (const bool rigid : {false, true}) {
    Ring ring(8, 0.28, kBox, rigid, 1);
    ring.scene.run.dt_fs = 1;
    const double energy = energy_of(ring.scene);
    const tests::LammpsFolder out;
    write_lammps(ring.scene, (out.folder.path() / "a").string());
    const Scene back = out.read_back(rigid ? "rigid_bonds = [1]" : "");
    EXPECT_EQ(back.system.reach, ring.scene.system.reach);
    EXPECT_NEAR(energy_of(back), energy, 1e-9 * energy);
    if (rigid) {
      EXPECT_THAT(
          error_message([&] { through_openmm(ring.scene); }),
          HasSubstr("OpenMM cannot express it: rigid bond 0-1 is of a cluster that goes around the box"));
      continue;
    }
    const Scene again = through_openmm(ring.scene);
    EXPECT_EQ(again.system.reach, ring.scene.system.reach);
    EXPECT_NEAR(energy_of(again), energy, 1e-9 * energy);
  }
}

TEST(Networks, OfFeneSpringsGoOnFromTheirEnd) {
  Ring ring(8, 0.28, kBox, false);
  ring.scene.terms.bonds.clear(), ring.scene.terms.angles.clear();
  for (int a = 0; a < 8; ++a) ring.scene.terms.fene.push_back({a, (a + 1) % 8, 1000, 0.4});
  ring.scene.terms.wca = Wca{0.2, 1, {}};
  const tests::LammpsFolder out;
  write_lammps(ring.scene, (out.folder.path() / "a").string());
  write_start(out.folder.path() / "end.toml", ring.scene.start);
  const Scene on = out.read_back("start = \"end.toml\"\nspecial_lj = [0, 1, 1]", "pair = \"wca\"");
  EXPECT_EQ(on.system.reach[0], Reach::kMolecule);
  EXPECT_THAT(on.notes, testing::Not(testing::Contains(HasSubstr("set aside"))));
}

TEST(Networks, RefuseTheMetricCorrectionByItsKey) {
  Ring ring(8, 0.28, kBox, true);
  ring.scene.run.metric_correction = true, ring.scene.run.temperature_k = 300;
  EXPECT_THAT(error_message([&] { Simulation(ring.scene, 1); }),
              HasSubstr("run.metric_correction: depends on"));
}

// Names atoms as the scene does.
TEST(Networks, SayWhichBondBreaksOrIsTooLong) {
  Ring ring(8, 0.28, kBox, false);
  ring.scene.terms.bonds.clear();
  ring.scene.terms.fene = {{6, 7, 1000, 0.3}, {7, 0, 1000, 0.27}};
  const auto said = [&] { return error_message<SimulationFailure>([&] { energy_of(ring.scene); }); };
  EXPECT_THAT(said(), HasSubstr("fene bond 7-0 broke"));
  ring.scene.terms.fene.clear();
  ring.scene.start.x(2, 0) += 0.69;
  EXPECT_THAT(said(), HasSubstr("over half the box"));
}

}  // namespace
}  // namespace taut::networks_tests
