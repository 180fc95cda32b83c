// Walls, pairs of their own, steered atoms, and anchors in a box: forces, pressure, work, and what bad ones are told.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ensembles/pressure.hpp"
#include "force_checks.hpp"
#include "kept_state.hpp"
#include "md/units.hpp"
#include "scene_energy.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"

namespace taut::walls_tests {
namespace {

using testing::HasSubstr;

TEST(Walls, ForcesAreTheSlopeOfTheEnergyOnBothSidesOfASlitAlongEveryAxis) {
  for (const int axis : {0, 1, 2}) {
    Terms terms;
    terms.walls = {{axis, -0.4, 1, 0.3, 2.0, {}, {0, 1, 2}}, {axis, 0.5, -1, 0.2, 5.0, 0.45, {0, 2}}};
    expect_forces_are_minus_the_slope(terms, columns({{0, 0.1, 0.2}, {0.2, 0, -0.1}, {-0.2, 0.25, 0.3}}));
  }
}

TEST(Walls, HaveTheTextbooksEnergy) {
  // 9–3 has its minimum −(√10/3) ε at (2/5)^(1/6) σ; the repulsive one is zero from there on.
  Terms terms;
  const double least = Wall::repulsive_cutoff(0.3);
  terms.walls = {{2, 0, 1, 0.3, 2.0, {}, {0}}};
  EXPECT_NEAR(evaluate(terms, columns({{0, 0, least}})).energy, -2 * std::sqrt(10.0) / 3, 1e-13);
  EXPECT_NEAR(evaluate(terms, columns({{0, 0, least}})).f(2, 0), 0, 1e-12);
  terms.walls[0].cutoff = least;
  EXPECT_EQ(evaluate(terms, columns({{0, 0, 1.0001 * least}})).energy, 0);
  EXPECT_NEAR(evaluate(terms, columns({{0, 0, 0.2}})).energy,
              2 * (2.0 / 15 * std::pow(1.5, 9) - std::pow(1.5, 3) + std::sqrt(10.0) / 3), 1e-12);
  EXPECT_THROW(evaluate(terms, columns({{0, 0, -0.01}})), SimulationFailure);
}

const SceneText kSlit{R"([molecule.gas]
atoms = [{name = "A", mass_u = 40, sigma_nm = 0.3, epsilon_kj_mol = 1}]
[[place]]
molecule = "gas"
count = 60
[[wall]]
axis = "z"
between_nm = [0.5, 2.5]
sigma_nm = 0.3
epsilon_kj_mol = 1
potential = "repulsive"
[build]
box_nm = [2, 2, 3.5]
[forcefield]
cutoff_nm = 1.0
pair = "lennard-jones"
[run]
dt_fs = 4
steps = 20000
log_every = 20
temperature_k = 300
thermostat = "langevin"
)"};

TEST(Walls, APlacedLiquidStartsBetweenThem) {
  const Scene scene = read(kSlit.text);
  EXPECT_GT(scene.start.x.row(2).minCoeff(), 0.5);
  EXPECT_LT(scene.start.x.row(2).maxCoeff(), 2.5);
  EXPECT_EQ(scene.terms.walls.size(), 2u);
  EXPECT_FALSE(scene.closed());
}

// Without a box two walls are two sections, between which there is any room.
TEST(Walls, OfTwoSectionsHaveTheRoomBetweenThem) {
  const std::string wall = "[[wall]]\naxis = \"z\"\nsigma_nm = 0.3\nepsilon_kj_mol = 1\n";
  const auto between = [&](const std::string& one, const std::string& other) {
    return "[molecule.bead]\natoms = [{name = \"A\", mass_u = 40}]\n[[place]]\nmolecule = \"bead\"\ncount = "
           "40\n" +
           wall + one + "\n" + wall + other + "\n";
  };
  for (const bool swapped : {false, true}) {
    const std::string above = "above_nm = -5", below = "below_nm = 50";
    const Scene scene = read(swapped ? between(below, above) : between(above, below));
    EXPECT_GT(scene.start.x.row(2).minCoeff(), -5 + 0.75 * 0.3);
    EXPECT_LT(scene.start.x.row(2).maxCoeff(), 50 - 0.75 * 0.3);
    EXPECT_EQ(scene.terms.walls.size(), 2u);
  }
  EXPECT_THAT(complaint(between("above_nm = 50", "below_nm = -5")), HasSubstr("wall: the walls leave no"));
}

// Without forces between atoms each wall bears N kT/(A ∫ exp(−U/kT) dz).
TEST(Walls, AnIdealGasPressesByItsTemperature) {
  Scene scene = read(SceneText{kSlit.with("epsilon_kj_mol = 1}", "epsilon_kj_mol = 1e-9}").text}
                         .with("pair = \"lennard-jones\"", "")
                         .text);
  const double kT = kBoltzmann * 300;
  double room = 0;
  const Wall& wall = scene.terms.walls[0];
  for (int k = 0; k < 4000; ++k) {  // the half up to the middle
    Terms one;
    one.walls = {wall};
    one.walls[0].atoms = {0};
    room += 2 * 1.0 / 4000 * std::exp(-evaluate(one, columns({{0, 0, 0.5 + (k + 0.5) / 4000}})).energy / kT);
  }
  const double expected = 60 * kT / (2 * 2 * room) * kBarPerUnit;
  Simulation simulation(scene);
  const Summary summary = simulation.run({});
  ASSERT_EQ(summary.walls.size(), 2u);
  for (const Estimate& pressure : summary.walls) {
    EXPECT_NEAR(pressure.value, expected, 4 * pressure.error);
    EXPECT_LT(pressure.error, 0.1 * expected);
  }
}

TEST(Walls, GoToOpenMMAndBack) {
  const Scene scene = read(kSlit.text), back = through_openmm(scene);
  ASSERT_EQ(back.terms.walls.size(), 2u);
  for (int w = 0; w < 2; ++w) {
    const Wall &a = scene.terms.walls[w], &b = back.terms.walls[w];
    EXPECT_EQ(std::tie(a.axis, a.at, a.faces, a.sigma, a.epsilon, a.cutoff, a.atoms),
              std::tie(b.axis, b.at, b.faces, b.sigma, b.epsilon, b.cutoff, b.atoms));
  }
}

TEST(Walls, BadOnesAreRefusedByName) {
  EXPECT_EQ(complaint(kSlit.text), "no error");
  const char *z = "axis = \"z\"", *bath = "thermostat = \"langevin\"";
  expect_said(kSlit,
              {{"between_nm = [0.5, 2.5]", "above_nm = 0.5", "wall.0.axis: in a box a wall"},
               {"2, 2, 3.5", "2, 2, 2.9", "the slit of 2 nm and the cutoff of 1 nm need a"},
               {"[0.5, 2.5]", "[2.5, 0.5]", "wall.0.between_nm: expected two numbers, the"},
               {"[0.5, 2.5]", "[0.5, 0.9]", "no room between them, expected more than 1.5 σ"},
               {"between_nm", "above_nm = 1\nbetween_nm", "expected one of between_nm"},
               {z, "axis = \"w\"", "wall.0.axis: there is no \"w\""},
               {z, "axis = \"z\"\natoms = [\"C\"]", "no atom is called \"C\""},
               {z, "axis = \"z\"\ncutoff_nm = 1", "cutoff_nm: has no effect"},
               {"sigma_nm = 0.3\nepsilon", "epsilon", "missing key \"sigma_nm\" in [wall.0]"},
               {"cutoff_nm = 1.0", "cutoff_nm = 1.0\ncoulomb = \"pme\"",
                "forcefield.coulomb: has no effect, it counts only between charges"},
               {bath, "thermostat = \"langevin\"\nbarostat = \"c-rescale\"", "a wall or a steered atom"},
               {"count = 60", "count = 1\ncentres_nm = [[1, 1, 3]]", "there is no room for"}});
}

// A chain that is grafted to a wall: its first atom is an anchor on it.
TEST(Walls, BearGraftedChains) {
  const Scene scene = read(R"(atom.B = {mass_u = 40, sigma_nm = 0.3, epsilon_kj_mol = 1}
atom.G = {mass_u = 0, sigma_nm = 0.3, epsilon_kj_mol = 1}
molecule.brush = {atoms = ["B"], units = 8, first = "G", bonds = [[0, 1, 0.3]]}
place = [{molecule = "brush", count = 9, arrange = "lattice", within_nm = [0, 0, 0, 2.4, 2.4, 0]}]
wall = [{axis = "z", between_nm = [0, 3], sigma_nm = 0.3, epsilon_kj_mol = 1}]
build = {box_nm = [2.4, 2.4, 4.2]}
forcefield = {cutoff_nm = 1.0}
)");
  EXPECT_EQ(scene.system.anchors(), 9);
  for (int a = 0; a < scene.system.atoms(); ++a) {
    EXPECT_EQ(scene.system.is_anchor(a), a % 8 == 0);
    if (a % 8 == 0)
      EXPECT_EQ(scene.start.x(2, a), 0);
    else
      EXPECT_GT(scene.start.x(2, a), 0.2);
  }
  EXPECT_EQ(scene.terms.walls[0].atoms.size(), 9u * 7);
}

// The forces among anchors leave the pressure: it is as if the anchors did not see each other.
TEST(Anchors, DoNotPressOnEachOther) {
  const std::string text =
      R"(molecule.wall = {atoms = [{name = "W", mass_u = 0, sigma_nm = 0.35, epsilon_kj_mol = 1, charge_e = 0.2}]}
molecule.gas = {atoms = [{name = "A", mass_u = 40, sigma_nm = 0.3, epsilon_kj_mol = 1, charge_e = -0.2}]}
place = [{molecule = "wall", count = 40}, {molecule = "gas", count = 40}]
build = {box_nm = 2.5}
forcefield = {cutoff_nm = 1.0}
)";
  for (const std::string coulomb : {"reaction-field", "pme"}) {
    Scene scene = read(text, {"forcefield.coulomb=\"" + coulomb + "\""});
    const auto virial = [&](const Terms& terms) {
      State s = scene.start;
      ForceField forces(scene.system, s.box, terms);
      ForceField::Evaluation evaluation;
      forces.evaluate(scene.system, s, evaluation);
      return forces.virial(s, evaluation);
    };
    const Eigen::Matrix3d counted = virial(scene.terms);
    if (coulomb == "pme") {  // −dE/dstrain of all energy, less that of the anchors alone
      const auto energy = [&](const Eigen::VectorXd& charge, const Eigen::VectorXd& epsilon, double strain) {
        Terms terms = scene.terms;
        terms.nonbonded->charge = charge;
        terms.nonbonded->epsilon = epsilon;
        terms.nonbonded->pme->alpha = 3.2;
        terms.nonbonded->pme->grid = {32, 32, 32};
        State s = scene.start;
        s.x.row(2) *= 1 + strain;
        s.box = s.box.scaled(Vec3(1, 1, 1 + strain));
        return ForceField(scene.system, s.box, terms).evaluate_energy(scene.system, s);
      };
      const Nonbonded& all = *scene.terms.nonbonded;
      Eigen::VectorXd charge = all.charge, epsilon = all.epsilon;
      charge.tail(40).setZero(), epsilon.tail(40).setZero();
      const auto slope = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& e) {
        return (energy(q, e, 1e-6) - energy(q, e, -1e-6)) / 2e-6;
      };
      scene.terms.nonbonded->pme->alpha = 3.2;
      scene.terms.nonbonded->pme->grid = {32, 32, 32};
      EXPECT_NEAR(virial(scene.terms)(2, 2), -slope(all.charge, all.epsilon) + slope(charge, epsilon),
                  1e-5 * std::abs(counted(2, 2)));
      continue;
    }
    Terms apart = scene.terms;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < i; ++j) apart.nonbonded->exceptions.push_back({j, i, 0, 1, 0});
    EXPECT_LT((counted - virial(apart)).norm(), 1e-9 * counted.norm());
    Terms mapped = scene.terms;  // a correction map of five anchors presses on nothing
    mapped.maps = {(Eigen::Matrix3d() << 0, 30, -10, 20, 5, -40, 15, -25, 10).finished()};
    mapped.cmaps = {{{0, 1, 2, 3}, {1, 2, 3, 4}, 0}};
    EXPECT_LT((counted - virial(mapped)).norm(), 1e-9 * counted.norm());
  }
}

// Three atoms in a row and a chain whose ends are 1-4 pairs, with pairs of their own.
const SceneText kPairs{R"([atom.A]
mass_u = 40
sigma_nm = 0.3
epsilon_kj_mol = 1
[atom.B]
mass_u = 40
sigma_nm = 0.4
epsilon_kj_mol = 2
[molecule.a]
atoms = ["A"]
[molecule.b]
atoms = ["B"]
[[place]]
molecule = "a"
centres_nm = [[0, 0, 0], [0, 0, 0.5]]
[[place]]
molecule = "b"
centres_nm = [[0, 0, 1.1]]
[[pair]]
atoms = ["B", "A"]
sigma_nm = 0.5
epsilon_kj_mol = 3
)"};

double lennard_jones(double sigma, double epsilon, double r) {
  const double s6 = std::pow(sigma / r, 6);
  return 4 * epsilon * (s6 * s6 - s6);
}

TEST(Pairs, HaveTheirOwnNumbersAndOthersMix) {
  const double a_a = lennard_jones(0.3, 1, 0.5);
  EXPECT_NEAR(energy_of(read(kPairs.text)), a_a + lennard_jones(0.5, 3, 0.6) + lennard_jones(0.5, 3, 1.1),
              1e-12);
  EXPECT_NEAR(energy_of(read(kPairs.with("[\"B\", \"A\"]", "[\"B\", \"B\"]").text)),
              a_a + lennard_jones(0.35, std::sqrt(2), 0.6) + lennard_jones(0.35, std::sqrt(2), 1.1), 1e-12);
  EXPECT_NEAR(energy_of(read(kPairs.with("[\"B\", \"A\"]", "[\"A\", \"A\"]").text)),
              lennard_jones(0.5, 3, 0.5) + lennard_jones(0.35, std::sqrt(2), 0.6) +
                  lennard_jones(0.35, std::sqrt(2), 1.1),
              1e-12);
}

TEST(Pairs, ScaleTheirOwnNumbersBetween14) {
  const Scene scene =
      read(kPairs
               .with("atoms = [\"A\"]",
                     "atoms = [\"A\", \"A\", \"A\", \"B\"]\nbonds = [[0, 1, 0.2], [1, 2, 0.2], [2, 3, "
                     "0.2]]\nlennard_jones_14 = 0.5")
               .text);
  for (const PairException& pair : scene.terms.nonbonded->exceptions)
    if (pair.epsilon > 0) {
      EXPECT_EQ(pair.sigma, 0.5);
      EXPECT_EQ(pair.epsilon, 0.5 * 3);
    }
  EXPECT_EQ(std::ranges::count_if(scene.terms.nonbonded->exceptions,
                                  [](const PairException& pair) { return pair.epsilon > 0; }),
            2);
}

TEST(Pairs, BadOnesAreRefusedByName) {
  const char *atoms = "[\"B\", \"A\"]", *numbers = "sigma_nm = 0.5\nepsilon_kj_mol = 3";
  const std::string again = "\n[[pair]]\natoms = [\"A\", \"B\"]\nsigma_nm = 1\nepsilon_kj_mol = 1";
  expect_said(kPairs, {{atoms, atoms, "no error"},
                       {atoms, "[\"B\", \"C\"]", "pair.0.atoms: no atom is called \"C\""},
                       {atoms, "[\"B\"]", "pair.0.atoms: expected two names"},
                       {numbers, numbers + again, "a second [[pair]] of \"A\" and \"B\""},
                       {"sigma_nm = 0.5", "sigma_nm = -1", "expected more than 0"},
                       {numbers, "sigma_nm = 0.5", "missing key \"epsilon_kj_mol\" in [pair.0]"}});
}

const std::string kPulled = R"([molecule.bead]
atoms = [{name = "B", mass_u = 50}]
steered = [[0, 0.03, 0, 0.04, 200]]
[[place]]
molecule = "bead"
centres_nm = [[1, 2, 3]]
[run]
dt_fs = 1
steps = 4000
log_every = 1000
[method]
name = "rattle"
)";

// A free bead behind the moving end of a spring: x = v(t − sin(ωt)/ω), ω² = k/m.
TEST(Steered, AFreeBeadFollowsTheMovingEnd) {
  const Scene scene = read(kPulled);
  Simulation simulation(scene);
  std::vector<Record> rows;
  simulation.run([&](const Record& r) { rows.push_back(r); });
  const double w = std::sqrt(200.0 / 50), v = 0.05;
  for (const Record& r : rows) {
    const double way = v * (r.t - std::sin(w * r.t) / w), speed = v * (1 - std::cos(w * r.t));
    EXPECT_NEAR(*r.steering_force, 200 * (v * r.t - way), 1e-5);
    // its work is what the bead and the spring have: in the moving frame the bead swings
    EXPECT_NEAR(*r.steering_work, 0.5 * 50 * speed * speed + 0.5 * 200 * std::pow(v * r.t - way, 2), 1e-6);
    EXPECT_NEAR(r.total(), *r.steering_work, 1e-7);  // to (ωh)² of velocity Verlet
    EXPECT_NEAR(r.but_for_heat(), 0, 1e-7);
  }
  EXPECT_NEAR(simulation.state().x(0, 0), 1 + 0.6 * v * (4 - std::sin(w * 4) / w), 1e-6);
  EXPECT_NEAR(simulation.state().x(2, 0), 3 + 0.8 * v * (4 - std::sin(w * 4) / w), 1e-6);
}

TEST(Steered, GoesOnFromACheckpointToTheLastBit) {
  const Scene scene = read(kPulled, {"run.thermostat=\"langevin\"", "run.temperature_k=300"});
  const auto [end, of_second] = expect_to_go_on_from(scene, 1500);
  EXPECT_EQ(*end.row.steering_work, *of_second.row.steering_work);
  EXPECT_EQ(end.row.steering_force, of_second.row.steering_force);
}

TEST(Steered, BadOnesAreRefusedByName) {
  expect_said({kPulled}, {{"0.03, 0, 0.04", "0, 0, 0", "steered[0]: expected a velocity that is not 0"},
                          {"200]", "-1]", "expected a stiffness k above 0"},
                          {"mass_u = 50", "mass_u = 0", "atom 0 is an anchor"}});
  EXPECT_THROW(through_openmm(read(kPulled)), InputError);
}

}  // namespace
}  // namespace taut::walls_tests
