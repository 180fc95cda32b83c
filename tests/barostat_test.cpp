// Volumes against closed forms, where there are any; what the box moves against what it must not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "base/statistics.hpp"
#include "ensembles/c_rescale.hpp"
#include "error_message.hpp"
#include "force_checks.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "pressure_of.hpp"
#include "simulation/inner.hpp"
#include "simulation/minimise.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut::barostat_tests {
namespace {

constexpr double kT = 2.5;  // [kJ/mol]

// Rigid dimers, or atoms, that do not meet.
struct IdealGas {
  Scene scene;
  State s;
  Random random{11};

  IdealGas(int molecules, int atoms_each, std::vector<RigidBond> bonds = {}) {
    const int n = molecules * atoms_each;
    scene.system = make_system(Eigen::VectorXd::LinSpaced(n, 1, 5), std::move(bonds));
    scene.run.dt_fs = 1000;
    scene.run.temperature_k = kT / kBoltzmann;
    scene.run.thermostat = "langevin";
    scene.run.pressure_bar = 40 * kBarPerUnit;  // 40 kJ/mol/nm³
    scene.run.compressibility_per_bar = 1 / scene.run.pressure_bar;
    scene.run.barostat_every = 1;
    scene.run.barostat_ps = 40;
    s.box.edge = Vec3::Constant(std::cbrt(molecules * kT / 40));
    s.x = Vectors::Random(3, n);
    s.v = Vectors::Zero(3, n);
    s.f = s.F = s.v;
    scene.start.box = s.box;
  }

  // Means over many steps of V P₀/kT and its square, from the middle on of each block; velocities are drawn
  // anew each step.
  struct Volumes {
    Estimate mean, square;
  };
  Volumes volumes(const std::string& barostat, const std::string& coupling, long steps) {
    scene.run.barostat = barostat;
    scene.run.coupling = coupling;
    RunForces forces(ForceField(scene.system, s.box, {}));
    const auto box = make_barostat(scene, 5, forces);
    RunningMean mean, square;
    for (long n = 0; n < steps; ++n) {
      for (int a = 0; a < scene.system.atoms(); ++a)
        s.v.col(a) = std::sqrt(kT / scene.system.mass[a]) * random.normal_vector();
      for (const auto& [i, j, d] : scene.system.bonds) rigid_rotor(i, j);
      box->after_step(scene.system, 1, s);
      box->move_box(scene.system, s);
      s.box.edge.setConstant(std::cbrt(s.box.volume()));  // a shape that nothing holds goes anywhere
      if (n < steps / 20) continue;
      const double v = s.box.volume() * 40 / kT;
      mean.add(v);
      square.add(v * v);
    }
    return {mean.estimate(), square.estimate()};
  }

  // Takes the part along the bond out, as masses have it.
  void rigid_rotor(int i, int j) {
    const Vec3 r = s.x.col(j) - s.x.col(i);
    const auto& m = scene.system.inv_mass;
    const double impulse = r.dot(s.v.col(j) - s.v.col(i)) / (r.squaredNorm() * (m[i] + m[j]));
    s.v.col(i) += m[i] * impulse * r;
    s.v.col(j) -= m[j] * impulse * r;
  }
};

// V of N free molecules at T and P has the density V^N exp(−PV/kT): the gamma distribution of shape N + 1,
// ⟨V⟩ = (N + 1) kT/P,   ⟨V²⟩ = (N + 1)(N + 2)(kT/P)².
void expect_gamma(const IdealGas::Volumes& volumes, int molecules) {
  const double N = molecules;
  EXPECT_GT(volumes.mean.error, 0);
  EXPECT_LT(volumes.mean.error, 0.2);  // so that N would show
  EXPECT_NEAR(volumes.mean.value, N + 1, 4 * volumes.mean.error);
  EXPECT_NEAR(volumes.square.value, (N + 1) * (N + 2), 4 * volumes.square.error);
}

struct Case {
  const char *barostat, *coupling;
};
class Barostats : public ::testing::TestWithParam<Case> {};

TEST_P(Barostats, GiveAnIdealGasItsVolumes) {
  IdealGas gas(30, 1);
  expect_gamma(gas.volumes(GetParam().barostat, GetParam().coupling, 200000), 30);
}

// Only the centres count.
TEST_P(Barostats, GiveAGasOfRigidDimersItsVolumes) {
  std::vector<RigidBond> bonds;
  for (int k = 0; k < 20; ++k) bonds.push_back({2 * k, 2 * k + 1, 0.1});
  IdealGas gas(20, 2, bonds);
  for (const auto& [i, j, d] : bonds) gas.s.x.col(j) = gas.s.x.col(i) + d * gas.random.unit_vector();
  expect_gamma(gas.volumes(GetParam().barostat, GetParam().coupling, 200000), 20);
  EXPECT_LT(bond_errors(gas.scene.system, gas.s.x).max, 1e-6);  // rounding, of all these moves
}

INSTANTIATE_TEST_SUITE_P(All, Barostats,
                         ::testing::Values(Case{"c-rescale", "isotropic"},
                                           Case{"c-rescale", "semi-isotropic"},
                                           Case{"c-rescale", "anisotropic"},
                                           Case{"monte-carlo", "isotropic"}),
                         [](const auto& test) { return "case" + std::to_string(test.index); });

// A distance of two atoms, held by a spring to a place that moves, at 0.8 nm at 8 ps, or that is there at all times.
Bias held_apart(const System& sys, bool moves) {
  Bias bias{.name = "apart", .groups = {make_group(sys, {0}), make_group(sys, {1})}, .k = 500};
  bias.lower = bias.upper = moves ? 0 : 0.8;
  bias.rate = moves ? 0.1 : 0;
  return bias;
}

// Whatever evaluates forces of a copy of the state evaluates them at its time: the volumes that a barostat tries, a
// pressure, and a minimum.
TEST(CopiesOfAState, AreOfItsOwnTime) {
  struct Found {
    double volume, pressure, distance;
  };
  const auto found = [](bool moves) {
    IdealGas gas(200, 1);
    Random random(5);
    for (int a = 0; a < 200; ++a) gas.s.x.col(a) = 0.3 * random.normal_vector();
    gas.s.t = 8;
    gas.scene.terms.biases = {held_apart(gas.scene.system, moves)};
    gas.scene.run.barostat = "monte-carlo";
    RunForces forces(ForceField(gas.scene.system, gas.s.box, gas.scene.terms));
    Found now{};
    now.pressure = tests::pressure_of(gas.scene.system, forces.field, gas.s).trace();
    State still = gas.s;
    minimise(gas.scene.system, forces.field, {.force = 1e-3}, still);
    now.distance = (still.x.col(1) - still.x.col(0)).norm();
    const auto box = make_barostat(gas.scene, 5, forces);
    for (int n = 0; n < 200; ++n) {
      box->after_step(gas.scene.system, 1, gas.s);
      box->move_box(gas.scene.system, gas.s);
    }
    now.volume = gas.s.box.volume();
    return now;
  };
  const Found moving = found(true), standing = found(false);
  EXPECT_EQ(moving.volume, standing.volume);
  EXPECT_EQ(moving.pressure, standing.pressure);
  EXPECT_NEAR(moving.distance, 0.8, 1e-5);
  EXPECT_EQ(moving.distance, standing.distance);
}

// All forces end at zero: switched, and in a conductor's reaction field or under Ewald's sum.
Scene water(std::vector<std::string> more, bool pme = false) {
  for (const char* key : {"forcefield.switch_nm=0.75", "run.dt_fs=1"}) more.push_back(key);
  more.push_back(pme ? "forcefield.coulomb=pme" : "forcefield.rf_dielectric=1e9");
  return scene_of("water", more);
}

// The centres of molecules of three and the box strained by 1 + ε along an edge, the molecules as they are.
double energy_strained(const Scene& scene, State s, int edge, double by) {
  const System& sys = scene.system;
  Vec3 scale = Vec3::Ones();
  scale[edge] += by;
  s.box = s.box.scaled(scale);
  for (int o = 0; o < sys.atoms(); o += 3) {
    const Vec3 centre = s.x.middleCols<3>(o) * sys.mass.segment<3>(o) / sys.mass.segment<3>(o).sum();
    s.x.middleCols<3>(o).row(edge).array() += by * centre[edge];
  }
  ForceField forces(sys, s.box, scene.terms);
  return forces.evaluate_energy(sys, s);
}

// V P = Σ M V² − dE/dε, the bonds held: virtual work; V the velocity of the drift that the step's forces begin.
TEST(CellRescaling, IsDrivenByThePressureOfTheCentres) {
  for (const bool pme : {false, true}) {
    const Scene scene = water({}, pme);
    State s = scene.start;
    RunForces forces(ForceField(scene.system, s.box, scene.terms));
    forces.evaluate(scene.system, s);
    CellRescaling barostat(scene.system, molecules(scene.system, {}), s.box,
                           {.pressure = 1, .kT = 1, .every = 1, .time_between = 1}, forces);
    s.F = s.f;
    constexpr double h = 5e-3;
    const Vec3 P = barostat.pressure(h, s);
    for (int edge = 0; edge < 3; ++edge) {
      double expected = 0;
      for (int o = 0; o < scene.system.atoms(); o += 3) {
        const auto mass = scene.system.mass.segment<3>(o);
        const double momentum =
            s.v.middleCols<3>(o).row(edge).dot(mass) + 0.5 * h * s.f.middleCols<3>(o).row(edge).sum();
        expected += std::pow(momentum, 2) / mass.sum();
      }
      const double step = 1e-7;  // so that no pair crosses the cutoff
      expected -=
          (energy_strained(scene, s, edge, step) - energy_strained(scene, s, edge, -step)) / (2 * step);
      EXPECT_NEAR(P[edge] * s.box.volume(), expected, 1e-4 * std::abs(expected)) << pme << edge;
    }
  }
}

// What no barostat does is done by a barostat no worse: bonds, and what methods know of them.
class Held : public ::testing::TestWithParam<const char*> {};

TEST_P(Held, BondsAreWhatTheyAreWithoutABarostat) {
  const auto errors = [&](std::vector<std::string> keys) {
    for (const char* key : {"run.steps=300", "run.log_every=5", "run.thermostat=langevin"})
      keys.push_back(key);
    keys.push_back(std::string("method.name=") + GetParam());
    Simulation simulation(water(std::move(keys)));
    const double before = simulation.state().box.volume();
    const Summary summary = simulation.run({});
    return std::pair(summary, simulation.state().box.volume() / before);
  };
  const auto [fixed, same] = errors({});
  EXPECT_EQ(same, 1);
  // Pushed hard, every step: by 2000 bar, which takes some percent of the volume.
  for (const char* barostat : {"c-rescale", "monte-carlo"}) {
    const auto [moved, shrunk] = errors({std::string("run.barostat=") + barostat, "run.barostat_every=1",
                                         "run.pressure_bar=2000", "forcefield.cutoff_nm=0.85"});
    EXPECT_LT(shrunk, 0.995) << barostat;
    // A trial of Monte Carlo's is a jump of all forces, which an extrapolated λ does not foresee.
    const std::string method = GetParam();
    const bool jumps =
        barostat == std::string("monte-carlo") && (method == "feedforward" || method == "baumgarte");
    const double leeway = jumps ? 20 : 1;
    EXPECT_LT(moved.rms_rel_bond_error, leeway * 1.3 * fixed.rms_rel_bond_error + 1e-13) << barostat;
    EXPECT_LT(moved.max_rel_bond_error, leeway * 2 * fixed.max_rel_bond_error + 1e-12) << barostat;
  }
}
INSTANTIATE_TEST_SUITE_P(All, Held, ::testing::Values("newton", "feedforward", "baumgarte", "settle"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Barostats, ThatNeverActAreRefused) {
  IdealGas gas(3, 1);
  RunForces forces(ForceField(gas.scene.system, gas.s.box, {}));
  gas.scene.run.barostat_every = 0;
  for (const char* name : {"c-rescale", "monte-carlo"}) {
    gas.scene.run.barostat = name;
    EXPECT_THROW(make_barostat(gas.scene, 7, forces), InputError);
  }
}

// Momentum and length change by opposite factors, what turns within a group by none: and the heat is told.
TEST(CellRescaling, ScalesVelocitiesOfCentresAgainstTheBox) {
  IdealGas gas(3, 2, {{0, 1, 0.1}, {2, 3, 0.1}, {4, 5, 0.1}});
  gas.s.v.setRandom();
  const System& sys = gas.scene.system;
  gas.scene.run.barostat = "c-rescale";
  gas.scene.run.coupling = "anisotropic";
  RunForces forces(ForceField(sys, gas.s.box, {}));
  const auto barostat = make_barostat(gas.scene, 7, forces);
  const State before = gas.s;
  barostat->after_step(gas.scene.system, 1, gas.s);
  const double given = barostat->move_box(sys, gas.s);
  EXPECT_NEAR(given, kinetic_energy(sys, gas.s.v) - kinetic_energy(sys, before.v), 1e-12);
  EXPECT_GT(std::abs(given), 1e-3);
  const auto scaled = [](const Vec3& sum, const State& s) { return sum.cwiseProduct(s.box.edge).eval(); };
  for (int a = 0; a < 6; a += 2) {
    const Vec3 now = gas.s.v.middleCols<2>(a) * sys.mass.segment<2>(a);
    const Vec3 then = before.v.middleCols<2>(a) * sys.mass.segment<2>(a);
    EXPECT_LT((scaled(now, gas.s) - scaled(then, before)).norm(), 1e-12);
    EXPECT_LT((gas.s.v.col(a) - gas.s.v.col(a + 1) - before.v.col(a) + before.v.col(a + 1)).norm(), 1e-12);
  }
}

// Each edge by itself, two of them alike, all alike.
TEST(CellRescaling, CouplesEdgesAsItIsTold) {
  for (const auto& [coupling, xy, xz] : {std::tuple{"isotropic", true, true},
                                         {"semi-isotropic", true, false},
                                         {"anisotropic", false, false}}) {
    Simulation simulation(water({"run.steps=50", "run.thermostat=langevin", "run.barostat=c-rescale",
                                 std::string("run.coupling=") + coupling}));
    simulation.run({});
    const Vec3 edge = simulation.state().box.edge;
    EXPECT_EQ(std::abs(edge.x() / edge.y() - 1) < 1e-12, xy) << coupling;
    EXPECT_EQ(std::abs(edge.x() / edge.z() - 1) < 1e-12, xz) << coupling;
    EXPECT_NE(edge.x(), simulation.scene().start.box.edge.x()) << coupling;
  }
}

TEST(Barostat, StopsBeforeTheBoxIsTooSmallForTheCutoff) {
  Simulation simulation(water({"run.steps=2000", "run.thermostat=langevin", "run.barostat=c-rescale",
                               "run.pressure_bar=20000", "run.log_every=1000"}));
  EXPECT_THAT(error_message<SimulationFailure>([&] { simulation.run({}); }),
              testing::AllOf(testing::HasSubstr("the box has shrunk"),
                             testing::HasSubstr("nm under the barostat (c-rescale)"),
                             testing::HasSubstr("larger system")));
}

// Nothing holds the shape of a gas: before numbers run out, or a bond is blamed.
TEST(Barostat, StopsWhereTheBoxRunsAway) {
  IdealGas gas(30, 1);
  gas.scene.run.barostat = "c-rescale";
  gas.scene.run.coupling = "anisotropic";
  RunForces forces(ForceField(gas.scene.system, gas.s.box, {}));
  const auto barostat = make_barostat(gas.scene, 5, forces);
  const Vec3 start = gas.s.box.edge;
  const auto apart = [&] {
    const Vec3 grown = gas.s.box.edge.cwiseQuotient(start);
    return grown.maxCoeff() / grown.minCoeff();
  };
  const auto compress_along_z = [&] {
    for (int a = 0; a < 30; ++a) gas.s.v.col(a) = Vec3(2, 2, 0);
    barostat->after_step(gas.scene.system, 1, gas.s);
    const State before = gas.s;
    try {
      barostat->move_box(gas.scene.system, gas.s);
    } catch (const SimulationFailure& e) {
      for (const char* word : {"the box has run to", "barostat (c-rescale", "run.coupling = \"isotropic\""})
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
      EXPECT_TRUE(gas.s.box == before.box && gas.s.x == before.x && gas.s.v == before.v);
      return false;
    }
    return true;
  };
  for (int step = 0; step < 100000 && compress_along_z(); ++step) ASSERT_LE(apart(), 10);
  EXPECT_GT(apart(), 5);
}

// It is no move, and counts as one that was refused.
TEST(MonteCarlo, TakesNoBoxThatIsTooNarrowForTheCutoff) {
  Simulation simulation(water({"run.steps=200", "run.thermostat=langevin", "run.barostat=monte-carlo",
                               "run.pressure_bar=20000", "run.barostat_every=1", "run.log_every=100",
                               "forcefield.cutoff_nm=0.93", "forcefield.switch_nm=0.8"}));
  const Summary summary = simulation.run({});
  EXPECT_EQ(summary.steps, 200);
  EXPECT_GE(simulation.state().box.edge.x(), 2 * 0.93);
  EXPECT_LT(simulation.state().box.edge.x(), 2 * 0.932);
  const auto tells = [](const std::string& doubt) {
    return doubt.find("trial boxes as too narrow for the cutoff") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(summary.doubts.begin(), summary.doubts.end(), tells), 1);
  Simulation free(water({"run.steps=20", "run.thermostat=langevin", "run.barostat=monte-carlo",
                         "run.barostat_every=1", "run.log_every=10"}));
  const auto none = free.run({}).doubts;
  EXPECT_EQ(std::count_if(none.begin(), none.end(), tells), 0);
}

// Sites go with their parents, and have no velocity of their own in a State.
TEST(CellRescaling, GivesVirtualSitesNoVelocity) {
  Simulation simulation(water({"build.model=tip4pew", "run.steps=50", "run.thermostat=langevin",
                               "run.barostat=c-rescale", "run.barostat_every=1", "run.pressure_bar=5000"}));
  const double before = simulation.state().box.volume();
  simulation.run({});
  EXPECT_LT(simulation.state().box.volume(), 0.999 * before);
  const System& sys = simulation.scene().system;
  ASSERT_FALSE(sys.sites.empty());
  for (const VirtualSite& site : sys.sites)
    EXPECT_EQ(simulation.state().v.col(site.atom), Vec3(Vec3::Zero())) << site.atom;
}

}  // namespace
}  // namespace taut::barostat_tests
