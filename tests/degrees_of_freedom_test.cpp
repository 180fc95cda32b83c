// Degrees of freedom beside the dimension of the space that velocities are in, by the numerical rank of what they obey,
// and what taking momentum out does beside anchors.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/random.hpp"
#include "error_message.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/velocities.hpp"

namespace taut::degrees_of_freedom_tests {
namespace {

using ::testing::HasSubstr;

struct Atoms {
  std::string name;
  std::vector<double> mass;
  std::vector<Vec3> x;
  std::vector<std::array<int, 2>> bonds;
  VirtualSites sites;
};

std::vector<Atoms> bodies() {
  const std::vector<Vec3> corners = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}, {0.08, 0.09, 0.07}};
  std::vector<std::array<int, 2>> all;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < i; ++j) all.push_back({j, i});
  return {{"nothing that moves", {}, {}, {}, {}},
          {"an atom", {2}, {corners[1]}, {}, {}},
          {"two atoms", {2, 3}, {corners[0], corners[1]}, {}, {}},
          {"a bond", {2, 3}, {corners[0], corners[1]}, {{0, 1}}, {}},
          {"a chain",
           {2, 3, 1, 4},
           {corners[0], corners[1], corners[4], corners[3]},
           {{0, 1}, {1, 2}, {2, 3}},
           {}},
          {"redundant bonds", {1, 2, 3, 4, 5}, corners, all, {}},
          {"a bond and its site",
           {2, 3, 0},
           {corners[0], corners[1], {0.05, 0, 0}},
           {{0, 1}},
           {VirtualSite::average(2, {{0, 0.5}, {1, 0.5}})}}};
}

enum class Anchors { kNone, kOne, kTwo, kThree, kBonded };

Scene scene_of(const Atoms& body, Anchors anchors, bool box) {
  std::vector<double> mass = body.mass;
  std::vector<Vec3> x = body.x;
  std::vector<RigidBond> bonds;
  for (const auto& [i, j] : body.bonds) bonds.push_back({i, j, (x[j] - x[i]).norm()});
  const int first = static_cast<int>(mass.size()),
            count = anchors == Anchors::kBonded ? 1 : static_cast<int>(anchors);
  const std::vector<Vec3> places = {{0.3, 0.2, 0.1}, {0.5, 0.1, 0.4}, {0.2, 0.6, 0.3}};
  for (int a = 0; a < count; ++a) mass.push_back(0), x.push_back(places[a]);
  if (anchors == Anchors::kBonded && first > 0) bonds.push_back({0, first, (x[first] - x[0]).norm()});
  Scene scene;
  scene.system = make_system(Eigen::Map<Eigen::VectorXd>(mass.data(), std::ssize(mass)), bonds, body.sites);
  scene.start.x.resize(3, std::ssize(x));
  for (std::size_t a = 0; a < x.size(); ++a) scene.start.x.col(static_cast<Eigen::Index>(a)) = x[a];
  scene.start.v = scene.start.f = Vectors::Zero(3, std::ssize(x));
  if (box) scene.start.box.edge = {2, 3, 4};
  scene.method = default_options(kUsualMethod);
  scene.run.redundant = "drop";
  return scene;
}

// Rows of what velocities of the atoms that move obey: J v = 0; Σ m v = 0 where that is taken out, or conserved at zero;
// and likewise Σ m (u + ω × x)·v of motions that move no anchor, where a start is at rest.
Eigen::MatrixXd obeyed(const Scene& scene) {
  const System& sys = scene.system;
  const int n = sys.atoms();
  const bool removed = scene.run.remove_momentum_every > 0, bath = scene.run.langevin();
  const bool at_rest = scene.start.v.isZero(0), box = scene.start.box.periodic();
  Eigen::MatrixXd generators(3 * n, 6), of_anchors(3 * n, 6);
  for (int a = 0; a < n; ++a)
    for (int k = 0; k < 6; ++k) {
      const Vec3 axis = Vec3::Unit(k % 3), e = k < 3 ? axis : Vec3(axis.cross(scene.start.x.col(a)));
      generators.block(3 * a, k, 3, 1) = e;
      of_anchors.block(3 * a, k, 3, 1) = sys.is_anchor(a) ? e : Vec3(Vec3::Zero());
    }
  Eigen::MatrixXd still = Eigen::MatrixXd::Identity(6, 6);
  if (sys.anchors() > 0) {
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(of_anchors);
    still = lu.dimensionOfKernel() > 0 ? Eigen::MatrixXd(lu.kernel()) : Eigen::MatrixXd(6, 0);
  }
  const bool breaks = bath || (removed && sys.anchors() > 0);  // what would be conserved
  Eigen::MatrixXd fixed(6, 0);
  if (at_rest && !breaks && !box) fixed = still;
  if (removed || (!breaks && sys.anchors() == 0)) {  // drawn velocities have none
    Eigen::MatrixXd more(6, fixed.cols() + 3);
    more << fixed, Eigen::MatrixXd::Identity(6, 3);
    fixed = more;
  }
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(sys.bond_count() + fixed.cols(), 3 * n);
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const Vec3 r = (scene.start.x.col(j) - scene.start.x.col(i)) / d;
    rows.block(k, 3 * j, 1, 3) = r.transpose();
    rows.block(k, 3 * i, 1, 3) = -r.transpose();
  }
  rows.bottomRows(fixed.cols()) = (generators * fixed).transpose();
  for (int a = 0; a < n; ++a) {  // of √m v, of atoms that move
    const double m = sys.mass[a];
    rows.block(0, 3 * a, sys.bond_count(), 3) *= m > 0 ? 1 / std::sqrt(m) : 0;
    rows.block(sys.bond_count(), 3 * a, fixed.cols(), 3) *= std::sqrt(m);
  }
  return rows;
}

int dimension(const Scene& scene) {
  const Eigen::MatrixXd rows = obeyed(scene);
  Eigen::FullPivLU<Eigen::MatrixXd> lu(rows);
  lu.setThreshold(1e-9);
  const int mobile = static_cast<int>((scene.system.mass.array() > 0).count());
  return 3 * mobile - static_cast<int>(rows.size() > 0 ? lu.rank() : 0);
}

TEST(DegreesOfFreedom, AreTheDimensionOfTheSpaceOfVelocities) {
  for (const Atoms& body : bodies())
    for (const Anchors anchors :
         {Anchors::kNone, Anchors::kOne, Anchors::kTwo, Anchors::kThree, Anchors::kBonded})
      for (const bool box : {false, true})
        for (const char* thermostat : {"none", "rescaling", "langevin"})
          for (const long removed : {0, 1, 7})
            for (const bool at_rest : {false, true}) {
              Scene scene = scene_of(body, anchors, box);
              if (scene.system.atoms() == 0) continue;
              const std::string which =
                  fmt::format("{}, anchors {}, box {}, {}, removed {}, at rest {}", body.name,
                              static_cast<int>(anchors), box, thermostat, removed, at_rest);
              scene.run.thermostat = thermostat;
              scene.run.thermostat_ps = 1;
              scene.run.temperature_k = 300;
              scene.run.remove_momentum_every = removed;
              scene.run.velocities = at_rest ? "keep" : "draw";
              give_velocities(scene);
              const int expected = dimension(scene);
              int counted = -1;
              double of_kinds = 0;
              const std::string refusal = error_message([&] {
                const Simulation simulation(scene);
                counted = simulation.dof().total();
                for (const MoleculeType& type : simulation.temperatures().types())
                  of_kinds += type.dof[0] + type.dof[1] + type.dof[2];
              });
              const bool anchored_bond = anchors == Anchors::kBonded && scene.system.bond_count() > 0;
              if (removed > 0 && anchored_bond) {
                EXPECT_THAT(refusal, HasSubstr("ends in an anchor")) << which;
              } else if (expected == 0 && scene.run.thermostatted()) {
                EXPECT_THAT(refusal, HasSubstr("nothing can move")) << which;
              } else {
                EXPECT_EQ(counted, expected) << which << ": " << refusal;
                EXPECT_NEAR(of_kinds, counted, 1e-9) << which;
              }
            }
}

// Atoms of different masses on springs to anchors, and on springs between them: what anchors give their centre is kept
// from it, so that no heat is lost that way and nine degrees of freedom have ½kT each.
Scene held_cloud(const std::string& thermostat, long removed) {
  constexpr int kAtoms = 4;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(2 * kAtoms);
  mass.head(kAtoms) << 10, 15, 20, 12;
  Scene scene;
  scene.system = make_system(mass, {});
  scene.start.x.resize(3, 2 * kAtoms);
  for (int a = 0; a < kAtoms; ++a) {
    scene.start.x.col(kAtoms + a) = Vec3(a, a % 2, 0.5 * (a % 3));
    scene.start.x.col(a) = scene.start.x.col(kAtoms + a) + Vec3(0.1, 0.1 * (a % 2), 0.1);
    scene.terms.bonds.push_back({a, kAtoms + a, 0.17, 1000.0 + 700 * a});
    for (int b = 0; b < a; ++b)
      scene.terms.bonds.push_back({b, a, (scene.start.x.col(a) - scene.start.x.col(b)).norm(), 500.0});
  }
  scene.start.v = scene.start.f = Vectors::Zero(3, 2 * kAtoms);
  scene.method = default_options(kUsualMethod);
  scene.run.dt_fs = 5;
  scene.run.temperature_k = 300;
  scene.run.thermostat = thermostat;
  scene.run.thermostat_ps = 0.3;
  scene.run.friction_per_ps = 2;
  scene.run.remove_momentum_every = removed;
  scene.run.log_every = 20;
  scene.run.steps = 400000;
  give_velocities(scene);
  return scene;
}

TEST(Momentum, IsSaidToBeStoppedWhereAStartHasSome) {
  for (const int removed : {0, 1}) {
    Scene scene = taut::scene_of("water");
    scene.start.v.colwise() += Vec3(0, 0.3, 0);
    scene.velocities_drawn = false;
    scene.run.remove_momentum_every = removed;
    const Simulation simulation(scene);
    const auto stopped =
        testing::Contains(testing::HasSubstr("the centre of mass moved at 0.3 nm/ps and was stopped"));
    EXPECT_THAT(simulation.scene().notes, testing::Conditional(removed > 0, stopped, testing::Not(stopped)));
    EXPECT_NEAR(momentum(scene.system, simulation.state().v).norm() / scene.system.mass.sum(),
                removed ? 0 : 0.3, 1e-9);
  }
}

TEST(MomentumOfWhatAnchorsHold, IsTakenOutWithoutWarmingOrCoolingTheRest) {
  for (const std::string thermostat : {"langevin", "rescaling", "none"}) {
    Scene scene = held_cloud(thermostat, 1);
    if (thermostat == "none") scene.run.steps = 20000;
    Simulation simulation(scene);
    EXPECT_EQ(simulation.dof().sum(), "3·4 − 0 − 3 = 9");
    double first = 0, last = 0, fastest = 0;
    const Summary summary = simulation.run(
        [&](const Record& r) {
          if (r.step == 0) first = r.but_for_heat();
          last = r.but_for_heat();
        },
        [&](long) { fastest = std::max(fastest, momentum(scene.system, simulation.state().v).norm()); });
    EXPECT_LT(fastest, 1e-9);
    EXPECT_EQ(simulation.state().x.rightCols(4), scene.start.x.rightCols(4)) << "anchors stay";
    EXPECT_NEAR(last, first, thermostat == "none" ? 0.05 : 1) << thermostat;
    if (thermostat != "none") {
      EXPECT_NEAR(summary.temperature, 300, 8) << thermostat;
    }
    EXPECT_THAT(summary.doubts, ::testing::IsEmpty());
  }
}

TEST(MomentumOfWhatAnchorsHold, IsNotedWhereItIsTakenOutMoreOftenThanAsked) {
  const auto noted = [](long every) {
    const Simulation simulation(held_cloud("none", every));
    return std::ranges::any_of(simulation.scene().notes, [](const std::string& note) {
      return note.find("the centre of mass is held at every step") != note.npos;
    });
  };
  EXPECT_TRUE(noted(7));
  EXPECT_FALSE(noted(1));
  EXPECT_FALSE(noted(0));
}

}  // namespace
}  // namespace taut::degrees_of_freedom_tests
