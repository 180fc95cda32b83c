// Bonds that end in virtual sites: special bodies, chains of rods from scenes, and what is refused.

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/settle.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "kept_state.hpp"
#include "md/observables.hpp"
#include "pressure_of.hpp"
#include "scene_text.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut::bonds_of_sites_tests {
namespace {

using testing::HasSubstr;
using tests::NoForce, tests::Start;

// A rod that does not turn, held at its centre of mass, moves as a ball of its mass.
TEST(BondsOfSites, ARodHeldAtItsCentreMovesAsABall) {
  struct Place {
    Start ball, rod;
  };
  const auto held = [](std::optional<Side> side) {
    Start ball, rod;
    const VirtualSites centre = {VirtualSite::average(3, {{1, 0.25}, {2, 0.75}})};
    const RigidBond to_ball{0, 1, 1}, to_rod{0, 3, 1}, along{1, 2, 0.8};
    ball.system = side ? make_system(Eigen::Vector2d(0, 4), {}, {}, {{to_ball, *side}})
                       : make_system(Eigen::Vector2d(0, 4), {to_ball});
    rod.system = side ? make_system(Eigen::Vector4d(0, 1, 3, 0), {along}, centre, {{to_rod, *side}})
                      : make_system(Eigen::Vector4d(0, 1, 3, 0), {along, to_rod}, centre);
    const Vec3 at = side ? Vec3(0.3, -0.2, 0) : Vec3(0.6, -0.8, 0),
               v = side ? Vec3(2, 3, 0.5) : Vec3(0.8, 0.6, 1);
    ball.state.x = ball.state.v = ball.state.f = Vectors::Zero(3, 2);
    rod.state.x = rod.state.v = rod.state.f = Vectors::Zero(3, 4);
    ball.state.x.col(1) = at;
    ball.state.v.col(1) = rod.state.v.col(1) = rod.state.v.col(2) = v;
    rod.state.x.col(1) = at + Vec3(0, 0, 0.6), rod.state.x.col(2) = at - Vec3(0, 0, 0.2);
    return Place{ball, rod};
  };
  const double h = 0.002;
  for (const auto side : {std::optional<Side>{}, std::optional{Side::kAtMost}})
    for (const std::string name : {"rattle", "shake", "baumgarte", "newton", "feedforward", "mshake"}) {
      if (side && !method_named(name).one_sided) continue;
      auto [ball, rod] = held(side);
      tests::UniformForce gravity(Vec3(0, -9.81, 0));
      const auto of_ball = make_method(ball.system, default_options(name), h),
                 of_rod = make_method(rod.system, default_options(name), h);
      initialize({ball.system, gravity, *of_ball}, h, ball.state);
      initialize({rod.system, gravity, *of_rod}, h, rod.state);
      for (int n = 0; n < 500; ++n) {
        ASSERT_TRUE(step({ball.system, gravity, *of_ball}, h, ball.state).held()) << name;
        ASSERT_TRUE(step({rod.system, gravity, *of_rod}, h, rod.state).held()) << name;
      }
      const Vec3 centre = 0.25 * rod.state.x.col(1) + 0.75 * rod.state.x.col(2);
      EXPECT_LT((centre - ball.state.x.col(1)).norm(), 1e-6) << name;
      EXPECT_NEAR(of_rod->lambda().tail(1)[0], of_ball->lambda()[0],
                  2e-5 * (1 + std::abs(of_ball->lambda()[0])))
          << name;
      EXPECT_GT((ball.state.x.col(1) - Vec3(0.3, -0.2, 0)).norm(), 0.3);
    }
}

// A bead on a bond of the centre of a water, which SETTLE then leaves to newton.
TEST(BondsOfSites, OfAWaterAreLeftToAnotherMethodBySettle) {
  Start start = tests::waters(3, 12, 300);
  const int n = 11;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  mass.head(9) = start.system.mass;
  mass[10] = 12;
  const VirtualSites site = {VirtualSite::average(9, {{3, 0.8}, {4, 0.1}, {5, 0.1}})};
  State s = start.state;
  for (Vectors* of : {&s.x, &s.v, &s.f}) {
    of->conservativeResize(3, n);
    of->rightCols(2).setZero();
  }
  place_sites(site, s.x);
  s.x.col(10) = s.x.col(9) + Vec3(0.1, 0.1, 0.05);
  std::vector<RigidBond> bonds = start.system.bonds;
  bonds.push_back({9, 10, 0.15});
  const System sys = make_system(mass, bonds, site);
  const auto parts = Settle::parts_of(sys);
  EXPECT_EQ(parts.rest, (std::vector{3, 4, 5, 9}));
  EXPECT_THAT(error_message([&] { make_method(sys, Settle::Options{.solute = "none"}, 0.001); }),
              HasSubstr("bond 3 (3-4) is not part of a three-site water"));
  Vectors by_newton;
  NoForce none;
  for (const MethodOptions& options :
       {MethodOptions(default_options("newton")), MethodOptions(Settle::Options{.solute = "newton"})}) {
    State now = s;
    const auto method = make_method(sys, options, 0.001);
    initialize({sys, none, *method}, 0.001, now);
    for (int k = 0; k < 200; ++k) ASSERT_TRUE(step({sys, none, *method}, 0.001, now).held());
    if (by_newton.cols() == 0) by_newton = now.x;
    EXPECT_LT((now.x - by_newton).leftCols(9).cwiseAbs().maxCoeff(), 1e-8);
  }
}

// Atoms in a row around the box, whose ring a bond of a site closes; or a site of each two closes it.
TEST(BondsOfSites, AroundTheBoxAreRefused) {
  Eigen::VectorXd mass = Eigen::VectorXd::Constant(8, 10);
  mass.tail(2).setZero();
  State start;
  start.box.edge = {1.8, 1.5, 1.4};
  start.x = Vectors::Zero(3, 8);
  std::vector<RigidBond> bonds;
  for (int a = 0; a < 6; ++a) {
    start.x.col(a) << 0.3 * a, 0.1 * (a % 2), 0;
    if (a > 0) bonds.push_back({a - 1, a, std::hypot(0.3, 0.1)});
  }
  const VirtualSites sites = {VirtualSite::average(6, {{0, 0.5}, {1, 0.5}}),
                              VirtualSite::average(7, {{4, 0.5}, {5, 0.5}})};
  place_sites(sites, start.x);
  const auto said = [&](const RigidBond& more) {
    bonds.push_back(more);
    System sys = make_system(mass, bonds, sites);
    bonds.pop_back();
    State s = start;
    return error_message([&] { make_whole(tethers(sys, {}), s, sys); });
  };
  EXPECT_THAT(said({5, 6, std::hypot(0.45, 0.05)}),
              HasSubstr("atoms 5 and 6: their bond ends in a virtual site"));
  EXPECT_THAT(said({7, 6, 0.6}), HasSubstr("virtual sites tie atoms together all around the box"));
  EXPECT_EQ(said({5, 6, 1.351}), "no error");  // as it stands
}

// Chains of rods, drawn.
const SceneText kChains{R"([build]
box_nm = 6
[molecule.rods]
atoms = [{name = "A", mass_u = 20}, {name = "B", mass_u = 10}, {name = "S", mass_u = 0}, {name = "T", mass_u = 0}]
units = 3
virtual_sites2 = [[2, 0, 1, -0.25], [3, 0, 1, 1.25]]
bonds = [[0, 1, 0.2], [3, 6, 0.15]]
[[place]]
molecule = "rods"
count = 100
[run]
dt_fs = 10
steps = 2000
log_every = 5
temperature_k = 300
thermostat = "langevin"
friction_per_ps = 1
)"};

// 6·3 − 5 degrees of freedom each, ½kT of each, and the pressure of a gas of molecules.
TEST(ChainsOfRods, AreDrawnAndHaveTheTemperatureAndThePressureOfAGas) {
  for (const char* method : {"newton", "feedforward"}) {
    const Scene scene = read(kChains.text, {fmt::format("method.name={}", method)});
    EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-9);
    Simulation simulation(scene);
    EXPECT_EQ(simulation.dof().total(), 100 * (6 * 3 - 5));
    const Summary end = simulation.run({});
    EXPECT_NEAR(end.temperature, 300, 2.5);
    const double right = 100 * kBoltzmann * 300 / 216 * kBarPerUnit;
    EXPECT_NEAR(end.pressure->value, right, 4 * end.pressure->error + 0.3) << right;
    EXPECT_LT(end.pressure->error, 0.05 * right);
    EXPECT_LT(std::abs(end.constraint_drift.value), 0.1);
    EXPECT_THAT(end.doubts, testing::IsEmpty());
  }
}

TEST(ChainsOfRods, GoOnFromACheckpointToTheLastBit) {
  for (const char* method : {"newton", "feedforward", "rattle"})
    expect_to_go_on_from(
        read(kChains.text, {"place.0.count=5", "run.steps=200", fmt::format("method.name={}", method)}), 110);
}

TEST(ChainsOfRods, AreDrawnWithRingsRopesAndSprings) {
  for (const auto& [old, changed] :
       std::vector<std::array<std::string, 2>>{{"units = 3", "units = 5\nring = true"},
                                               {"units = 3", "units = 3\nat_most = [[2, -1, 0.6]]"},
                                               {"units = 3", "units = 3\nsprings = [[3, 4, 0.18, 100]]"}}) {
    const Scene scene = read(kChains.with(old, changed).text, {"place.0.count=5"});
    EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-6) << changed;
  }
}

// One end of a rod is moved; bonds of its sites pull at it, and the work done is the energy it brings.
TEST(BondsOfSites, PullAtAnAnchorThatMoves) {
  const std::string text = R"([molecule.crank]
atoms = [{name = "O", mass_u = 0}, {name = "A", mass_u = 4}, {name = "S", mass_u = 0}, {name = "B", mass_u = 3}]
virtual_sites2 = [[2, 0, 1, 0.5]]
bonds = [[0, 1, 1], [2, 3, 0.5]]
coordinates_nm = [[0, 0, 0], [1, 0, 0], [0.5, 0, 0], [0.5, 0.3, 0.4]]
[[place]]
molecule = "crank"
centres_nm = [[0.5, 0.075, 0.1]]
[[motion]]
atoms = [0]
shake_nm = [0, 0.1, 0.05]
period_ps = 1.3
[run]
dt_fs = 1
steps = 3000
log_every = 100
)";
  for (const char* method : {"newton", "rattle", "feedforward", "mshake"}) {
    Simulation simulation(read(text, {fmt::format("method.name={}", method)}));
    double first = 0, most = 0, swing = 0;
    simulation.run([&](const Record& r) {
      if (r.step == 0) first = r.but_for_heat();
      most = std::max(most, std::abs(r.but_for_heat() - first));
      swing = std::max(swing, std::abs(r.total()));
    });
    EXPECT_LT(most, 1e-3 * swing) << method;
    EXPECT_GT(swing, 0.1);
  }
}

TEST(BondsOfSites, ThatCannotBeAreRefusedByName) {
  const auto refused = [](const Eigen::VectorXd& mass, const RigidBond& bond, const VirtualSites& sites) {
    return error_message([&] { make_system(mass, {bond}, sites); });
  };
  Eigen::VectorXd mass(6);
  mass << 1, 1, 1, 0, 0, 1;
  const VirtualSite out = VirtualSite::out_of_plane(3, 0, 1, 2, {0.5, 0.25, 0.75}),
                    on_it = VirtualSite::average(4, {{3, 0.5}, {0, 0.5}}),
                    middle = VirtualSite::average(3, {{0, 0.5}, {1, 0.5}});
  EXPECT_THAT(refused(mass, {3, 5, 1}, {out}),
              HasSubstr("bond 0 (3-5): atom 3 is a virtual site out of the plane"));
  EXPECT_THAT(refused(mass, {5, 4, 1}, {out, on_it}), HasSubstr("atom 4 is a virtual site out of the plane"));
  EXPECT_THAT(refused(mass, {3, 4, 1}, {middle, VirtualSite::average(4, {{1, 0.5}, {0, 0.5}})}),
              HasSubstr("bond 0 (3-4): the weights of its virtual sites put both its ends at one place"));
  Eigen::VectorXd anchored = mass;
  anchored[0] = anchored[1] = anchored[2] = 0;
  EXPECT_THAT(refused(anchored, {3, 2, 1}, {middle}), HasSubstr("both ends are anchored"));

  const char* three = "virtual_sites2 = [[2, 0, 1, -0.25], [3, 0, 1, 1.25]]";
  expect_said(kChains,
              {{three, std::string(three) + "\nat_least = [[2, 3, 0.1], [3, 6, 0.1]]",
                "tied by a rigid bond already"},
               {"[3, 6, 0.15]]", "[3, 6, 0.15], [2, 2, 0.1]]", "names the same atom twice"},
               {three, "virtual_sites2 = [[2, 0, 1, -0.25]]\nvirtual_sites3out = [[3, 0, 1, 2, 0.1, 0.1, 1]]",
                "bonds[1]: atom 3 is a virtual site out of the plane of its parents (virtual_sites3out)"}});
  struct Own {
    std::vector<Option> describe() { return {}; }
  };
  const auto make = [](const System&, const std::any&, double) {
    return std::make_unique<ConstraintMethod>();
  };
  add_method({.name = "own of linked bodies",
              .summary = "a test's",
              .defaults = Own{},
              .describe = [](std::any&) { return std::vector<Option>{}; },
              .make = make,
              .make_plain = make});
  const Scene chains = read(kChains.text, {"place.0.count=2"});
  EXPECT_THAT(error_message([&] { make_method(chains.system, Own{}, 0.01); }),
              HasSubstr("\"own of linked bodies\" is not taut's own, and is not told"));
  EXPECT_THAT(error_message([&] { openmm_system_xml(openmm_input(chains)); }),
              HasSubstr("holds atom 3, which is a virtual site, and OpenMM takes no constraint"));
}

}  // namespace
}  // namespace taut::bonds_of_sites_tests
