// Anchors that move as prescribed: bonds to them, and what it takes to move them.

#include <fmt/format.h>

#include <functional>
#include <numbers>

#include "kept_state.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "systems/lammps/write_data.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/openmm/import.hpp"

namespace taut::motions_tests {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

constexpr double kG = 9.81;  // [nm/ps²]
const std::vector<std::string> kMethods = {"newton",      "mshake", "rattle", "baumgarte",
                                           "feedforward", "lincs",  "none"};

std::vector<Record> rows_of(Simulation& simulation) {
  std::vector<Record> rows;
  simulation.run([&](const Record& r) { rows.push_back(r); });
  return rows;
}

// y'' = f(t, y), by Runge and Kutta's method.
struct Oscillator {
  double t = 0, y, rate;

  void advance(double h, const std::function<double(double, double)>& f) {
    const double a = f(t, y), p = rate;
    const double b = f(t + h / 2, y + h / 2 * p), q = rate + h / 2 * a;
    const double c = f(t + h / 2, y + h / 2 * q), r = rate + h / 2 * b;
    const double d = f(t + h, y + h * r), s = rate + h * c;
    y += h / 6 * (p + 2 * q + 2 * r + s);
    rate += h / 6 * (a + 2 * b + 2 * c + d);
    t += h;
  }
};

const SceneText kPendulum{R"(motion = [{atoms = [0], velocity_nm_ps = [0.3, 0.5, 0.1]}]
run = {dt_fs = 1, steps = 3000, log_every = 500}
[build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [1, 0, 0, 1]]
velocities = [[0, 0, 0], [0.3, 0.5, 0.1]]
bonds = [[0, 1, 1]]
gravity_nm_ps2 = [0, -9.81, 0]
)"};

// Who moves along with it sees a pendulum at rest.
TEST(MovingAnchors, APendulumAtConstantVelocitySwingsAsAtRest) {
  const Vec3 velocity(0.3, 0.5, 0.1);
  for (const std::string& name : kMethods) {
    Scene scene = read(kPendulum.text, {"method.name=" + name});
    Simulation moving(scene);
    scene.motions.clear();
    scene.start.v.setZero();
    Simulation resting(scene);
    const std::vector<Record> rows = rows_of(moving), at_rest = rows_of(resting);
    const Vectors away = (moving.state().x - resting.state().x).colwise() - velocity * moving.state().t;
    EXPECT_LT(away.norm(), 1e-9) << name;
    EXPECT_EQ(moving.state().x.col(0), velocity * moving.state().t) << name;
    EXPECT_LT((moving.bond_tensions() - resting.bond_tensions()).norm(), 1e-7) << name;
    for (std::size_t n = 0; n < rows.size(); ++n) {
      // by h² of velocity Verlet, where 10 kJ/mol go in and out
      EXPECT_NEAR(rows[n].but_for_heat(), rows[0].but_for_heat(), name == "none" ? 0.01 : 1e-4)
          << name << ' ' << rows[n].t;
      EXPECT_NEAR(rows[n].constraint_work, at_rest[n].constraint_work, 1e-6) << name;
    }
    EXPECT_GT(std::abs(*rows.back().steering_work), 1) << name;
  }
}

// A bead at the end of an arm that turns: what holds it is m ω²(R + d), and nothing is to be done.
TEST(MovingAnchors, ATurningArmIsPulledByTheCentrifugalForce) {
  const SceneText arm{
      R"(motion = [{atoms = [0], turn_deg_ps = [0, 0, 114.59155902616465], about_nm = [1, 1, 0]}]
run = {dt_fs = 0.5, steps = 3000}
[build]
kind = "atoms"
atoms = [[2, 1, 0, 0], [3, 1, 0, 5]]
velocities = [[0, 0, 0], [0, 4, 0]]
bonds = [[0, 1, 1]]
)"};
  for (const std::string& name : kMethods) {
    Simulation simulation(read(arm.text, {"method.name=" + name}));
    const std::vector<Record> rows = rows_of(simulation);
    const double angle = 2 * 1.5;
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const State& s = simulation.state();
    EXPECT_LT((s.x.col(0) - Vec3(1, 1, 0) - along).norm(), 1e-12) << name;
    EXPECT_LT((s.x.col(1) - Vec3(1, 1, 0) - 2 * along).norm(), 1e-5) << name;
    EXPECT_LT((s.v.col(0) - 2 * Vec3(-along.y(), along.x(), 0)).norm(), 1e-12) << name;
    EXPECT_NEAR(simulation.bond_tensions()[0], 5 * 2 * 2 * 2, 1e-4) << name;
    EXPECT_NEAR(*rows.back().steering_work, 0, 1e-4) << name;
    EXPECT_NEAR(rows.back().motions.at(0), 0, 1e-3) << name;
  }
}

// Kapitza's pendulum: φ'' = (g + y'')/l sin φ of the angle from the upright one, y = a sin Ωt. It stands where
// (aΩ)² > 2gl, and swings about it with (aΩ)²/2l² − g/l.
TEST(MovingAnchors, APendulumShakenAtItsPivotStandsUpright) {
  const double a = 0.05, rate = 2 * pi / 0.05, angle = 0.2;
  const SceneText shaken{fmt::format(R"([build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [{}, {}, 0, 1]]
velocities = [[0, 0, 0], [0, {}, 0]]
bonds = [[0, 1, 1]]
gravity_nm_ps2 = [0, -9.81, 0]
[[motion]]
atoms = [0]
shake_nm = [0, 0.05, 0]
period_ps = 0.05
[run]
dt_fs = 0.2
steps = 20000
log_every = 100
)",
                                     std::sin(angle), std::cos(angle), a * rate)};
  for (const std::string name : {"newton", "rattle", "feedforward", "lincs"}) {
    Simulation simulation(read(shaken.text, {"method.name=" + name}));
    Oscillator by_hand{0, angle, 0};
    const auto slope = [&](double t, double phi) {
      return (kG - a * rate * rate * std::sin(rate * t)) * std::sin(phi);
    };
    double most = 0, least_height = 1;
    int crossings = 0;
    double before = angle;
    double energy = NAN;
    simulation.run([&](const Record& r) {
      if (std::isnan(energy)) energy = r.but_for_heat();
      EXPECT_NEAR(r.but_for_heat(), energy, 0.02) << name;  // where 10 kJ/mol go in and out
      while (by_hand.t < r.t - 1e-9) by_hand.advance(2e-5, slope);
      const Vec3 arm = simulation.state().x.col(1) - simulation.state().x.col(0);
      const double phi = std::atan2(arm.x(), arm.y());
      most = std::max(most, std::abs(phi - by_hand.y));
      least_height = std::min(least_height, arm.y());
      crossings += phi * before < 0;
      before = phi;
    });
    EXPECT_LT(most, 2e-3) << name;
    EXPECT_GT(least_height, 0.85) << name;  // the start throws it, at φ' = 0 where the pivot is fastest
    EXPECT_EQ(crossings, 4) << name;        // in 4 ps, of a period of 1.99 ps
  }
  Simulation falls(read(shaken.with("shake_nm = [0, 0.05, 0]", "shake_nm = [0, 0.03, 0]").text));
  double lowest = 1;
  falls.run([&](const Record&) { lowest = std::min(lowest, falls.state().x(1, 1)); });
  EXPECT_LT(lowest, -0.5);
}

// A motor turns the crank of a linkage, whose coupler and rocker meet in B; a pendulum hangs there. B is where two circles
// cut, and the pendulum obeys θ'' = −((g + B''_y) sin θ + B''_x cos θ)/l.
TEST(MovingAnchors, AMotorDrivesALinkageAsTwoCirclesHaveIt) {
  const double omega = 2 * pi / 2;
  const auto joint = [&](double t) {
    const Vec3 crank(0.5 * std::cos(omega * t), 0.5 * std::sin(omega * t), 0), rocker(2, 0, 0);
    const Vec3 between = rocker - crank;
    const double d = between.norm(), along = (1.8 * 1.8 - 1.2 * 1.2 + d * d) / (2 * d);
    const double across = std::sqrt(1.8 * 1.8 - along * along);
    return Vec3(crank + along / d * between + across / d * Vec3(-between.y(), between.x(), 0));
  };
  const auto acceleration = [&](double t) {
    const double e = 1e-4;
    return Vec3((joint(t + e) - 2 * joint(t) + joint(t - e)) / (e * e));
  };
  const Vec3 at = joint(0), rate = (joint(1e-6) - joint(-1e-6)) / 2e-6;
  const SceneText linkage{fmt::format(R"([build]
kind = "atoms"
atoms = [[0.5, 0, 0, 0], [2, 0, 0, 0], [{0}, {1}, 0, 2], [{0}, {2}, 0, 1]]
velocities = [[0, 0, 0], [0, 0, 0], [{3}, {4}, 0], [{3}, {4}, 0]]
bonds = [[0, 2, 1.8], [1, 2, 1.2], [2, 3, 0.7]]
gravity_nm_ps2 = [0, -9.81, 0]
[[motion]]
atoms = [0]
turn_deg_ps = [0, 0, 180]
about_nm = [0, 0, 0]
[run]
dt_fs = 0.5
steps = 8000
log_every = 100
)",
                                      at.x(), at.y(), at.y() - 0.7, rate.x(), rate.y())};
  for (const std::string name : {"newton", "rattle", "mshake", "feedforward", "baumgarte"}) {
    Simulation simulation(read(linkage.text, {"method.name=" + name}));
    Oscillator pendulum{0, 0, 0};
    const auto swing = [&](double t, double theta) {
      const Vec3 b = acceleration(t);
      return -((kG + b.y()) * std::sin(theta) + b.x() * std::cos(theta)) / 0.7;
    };
    double energy = NAN;
    simulation.run([&](const Record& r) {
      const Vectors& x = simulation.state().x;
      EXPECT_LT((x.col(2) - joint(r.t)).norm(), 1e-6) << name << ' ' << r.t;
      while (pendulum.t < r.t - 1e-9) pendulum.advance(5e-4, swing);
      const Vec3 arm = x.col(3) - x.col(2);
      EXPECT_NEAR(std::remainder(std::atan2(arm.x(), -arm.y()) - pendulum.y, 2 * pi), 0, 1e-3)
          << name << ' ' << r.t;
      if (std::isnan(energy)) energy = r.but_for_heat();
      EXPECT_NEAR(r.but_for_heat(), energy, 2e-3) << name << ' ' << r.t;
    });
    // What the motor gives is what accelerates and lifts: the crank's bar pulls along A − B.
    const State& s = simulation.state();
    const Eigen::VectorXd tension = simulation.bond_tensions();
    const Vec3 bar = (s.x.col(2) - s.x.col(0)) / 1.8;
    EXPECT_NEAR(simulation.full_record().motions.at(0), -tension[0] * bar.dot(s.v.col(0)), 1e-9) << name;
    const Vec3 of_b = tension[0] * (s.x.col(0) - s.x.col(2)) / 1.8 +
                      tension[1] * (s.x.col(1) - s.x.col(2)) / 1.2 +
                      tension[2] * (s.x.col(3) - s.x.col(2)) / 0.7 - Vec3(0, 2 * kG, 0);
    EXPECT_LT((of_b - 2 * acceleration(s.t)).norm(), 1e-2) << name;
  }
}

// Along a way, and with pair forces, springs and a bath: the work closes the account, and a checkpoint goes on.
const SceneText kDragged{
    R"(molecule.wall = {atoms = [{name = "W", mass_u = 0, sigma_nm = 0.3, epsilon_kj_mol = 1}]}
atom.B = {mass_u = 40, sigma_nm = 0.3, epsilon_kj_mol = 1}
atom.R = {mass_u = 0, sigma_nm = 0.3, epsilon_kj_mol = 1}
molecule.brush = {atoms = ["B"], first = "R", units = 5, bonds = [[0, 1, 0.3]]}
place = [{molecule = "wall", centres_nm = [[0.5, 0.5, 0.5], [1.5, 1.5, 0.5], [0.5, 1.5, 0.5]]},
  {molecule = "brush", count = 12}]
motion = [{atoms = ["W"], way_nm = [[0, 0, 0, 0], [0.5, 0.3, 0, 0], [1, 0.3, 0.2, 0], [1.5, 0, 0, 0]]},
  {atoms = ["R"], velocity_nm_ps = [0.2, 0, 0]}]
build = {box_nm = [2.4, 2.4, 2.4]}
forcefield = {pair = "lennard-jones", cutoff_nm = 1.0, switch_nm = 0.8}
run = {dt_fs = 2, steps = 800, log_every = 50, temperature_k = 200, minimise = true}
)"};

TEST(MovingAnchors, TheWorkOfMovingThemClosesTheAccount) {
  for (const std::string name : {"newton", "rattle", "lincs", "feedforward", "baumgarte"}) {
    std::vector<std::string> settings = {"method.name=" + name};
    if (name == "rattle") settings.push_back("method.tolerance=1e-12");
    if (name == "lincs") settings.insert(settings.end(), {"method.order=12", "method.iterations=6"});
    for (const char* bath : {"none", "langevin"}) {
      std::vector<std::string> all = settings;
      all.push_back(std::string("run.thermostat=\"") + bath + "\"");
      if (bath == std::string("langevin")) all.emplace_back("run.friction_per_ps=50");
      Simulation simulation(read(kDragged.text, all));
      const std::vector<Record> rows = rows_of(simulation);
      const double first = rows[0].but_for_heat();
      for (const Record& r : rows) {
        EXPECT_NEAR(r.but_for_heat(), first, 0.5) << name << ' ' << bath << ' ' << r.t;
        EXPECT_LT(std::abs(r.constraint_work), 0.1) << name << ' ' << bath << ' ' << r.t;
      }
      EXPECT_GT(std::abs(*rows.back().steering_work), 2) << name << ' ' << bath;
    }
  }
}

TEST(MovingAnchors, GoOnFromACheckpointToTheLastBit) {
  for (const char* bath : {"run.thermostat=\"none\"", "run.thermostat=\"langevin\""}) {
    const std::string name = std::string(bath).find("none") == std::string::npos ? "newton" : "feedforward";
    const auto [end, of_second] =
        expect_to_go_on_from(read(kDragged.text, {bath, "method.name=" + name}), 500);
    EXPECT_EQ(*end.row.steering_work, *of_second.row.steering_work);
    EXPECT_EQ(end.row.motions, of_second.row.motions);
  }
}

// Set out anew, as from Python: they go on from where they are put.
TEST(MovingAnchors, SetOutAnewFromWhereTheyArePut) {
  Simulation simulation(read(kPendulum.text));
  simulation.run({}, [&](long step) {
    if (step == 1000) simulation.stop();
  });
  Vectors x = simulation.state().x;
  x.colwise() += Vec3(0, 0, 2);
  simulation.set_out_anew(x, simulation.state().v);
  simulation.run({});
  EXPECT_LT((simulation.state().x.col(0) - Vec3(0.9, 1.5, 2.3)).norm(), 1e-12);
}

// Anchors without bonds keep their velocity where a thermostat scales others.
TEST(MovingAnchors, KeepTheirVelocityUnderRescaling) {
  const SceneText loose{
      std::string(kDragged.text)
          .replace(kDragged.text.find("bonds = [[0, 1, 0.3]]"), 21, "springs = [[0, 1, 0.3, 500]]")};
  Simulation simulation(read(loose.text, {"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.1"}));
  const Vectors start = simulation.state().x;
  const std::vector<Record> rows = rows_of(simulation);
  for (int a = 0; a < simulation.state().x.cols(); ++a)
    if (simulation.scene().system.is_anchor(a) && a >= 3) {
      EXPECT_EQ(simulation.state().v.col(a), Vec3(0.2, 0, 0));
      EXPECT_LT((simulation.state().x.col(a) - start.col(a) - Vec3(0.32, 0, 0)).norm(), 1e-12);
    }
  EXPECT_NEAR(rows.back().but_for_heat(), rows[0].but_for_heat(), 0.5);
}

TEST(MovingAnchors, WhatCannotHoldTheirBondsIsRefused) {
  const auto refusal = [](const std::vector<std::string>& settings) {
    return error_message([&] { Simulation simulation(read(kDragged.text, settings)); });
  };
  EXPECT_THAT(
      refusal({"method.name=shake"}),
      HasSubstr("method.name: shake leaves velocities along the bonds, take rattle or newton: bond 0"));
  EXPECT_THAT(refusal({"run.thermostat=\"rescaling\"", "run.thermostat_ps=1"}),
              HasSubstr("run.thermostat: rescaling scales velocities that the motion prescribes"));
  const Scene scene = read(kDragged.text);
  EXPECT_THAT(error_message([&] { openmm_input(scene); }), HasSubstr("is an anchor that moves (motion.0)"));
  EXPECT_THAT(error_message([&] { lammps_files(scene, "d"); }), HasSubstr("anchors that move"));
}

// A ring of beads around the box, with an anchor that moves.
Scene ring_around_the_box(int anchor, const std::string& motion) {
  constexpr int n = 8;
  const double d = 0.28, step = 2.0 / n, height = std::sqrt(d * d - step * step);
  Scene scene;
  State& s = scene.start;
  s.box = Box{{2, 1.5, 1.4}};
  s.x = s.v = s.f = Vectors::Zero(3, n);
  Eigen::VectorXd mass = Eigen::VectorXd::Constant(n, 10);
  mass[anchor] = 0;
  std::vector<RigidBond> bonds;
  for (int a = 0, next = 1; a < n; ++a, next = (a + 1) % n) {
    s.x.col(a) = Vec3(step * a + 0.01, 0.3 + (a % 2 == 1 ? height : 0), 0.4);
    if (a > 0) s.v.col((a + anchor) % n) = 0.3 * Vec3(std::sin(a), std::cos(2 * a), std::sin(3 * a));
    bonds.push_back({a, next, d});
    scene.terms.angles.push_back({a, next, (a + 2) % n, 2.0, 80});
  }
  scene.system = make_system(std::move(mass), std::move(bonds));
  scene.names = guessed_names(scene.system, scene.terms);
  make_whole(tethers(scene.system, scene.terms), s, scene.system);
  scene.method = default_options("newton");
  scene.run.dt_fs = 1, scene.run.steps = 500, scene.run.log_every = 50;
  apply_overrides(scene, {fmt::format("motion=[{{atoms=[{}], {}}}]", anchor, motion)});
  return scene;
}

// A bond through the box pulls at an anchor as others do.
TEST(MovingAnchors, OfARingAroundTheBoxAreAllAlike) {
  const char* shaken = "shake_nm=[0.1, 0.1, 0], period_ps=0.5";
  Simulation at_the_edge(ring_around_the_box(0, shaken)), within(ring_around_the_box(4, shaken));
  const std::vector<Record> edge = rows_of(at_the_edge), middle = rows_of(within);
  for (std::size_t n = 0; n < edge.size(); ++n) {
    EXPECT_NEAR(edge[n].but_for_heat(), edge[0].but_for_heat(), 0.03) << edge[n].t;
    EXPECT_NEAR(*edge[n].steering_work, *middle[n].steering_work, 1e-6) << edge[n].t;
    EXPECT_NEAR(edge[n].motions.at(0), middle[n].motions.at(0), 1e-5) << edge[n].t;
  }
  EXPECT_GT(std::abs(*edge.back().steering_work), 10);
}

// Anchors that are near through the box are as near as the bonds between them lead.
TEST(MovingAnchors, ReachThroughTheBox) {
  const auto told = [](const std::string& motion) {
    return error_message([&] {
      Scene scene = ring_around_the_box(0, "shake_nm=[0, 0.1, 0], period_ps=0.5");
      scene.motions.clear();
      scene.system.mass[6] = scene.system.inv_mass[6] = 0;
      apply_overrides(scene, {"motion=[{atoms=[0], " + motion + "}]"});
    });
  };
  EXPECT_EQ(told("velocity_nm_ps=[-0.1, 0, 0]"), "no error");  // towards it
  EXPECT_THAT(
      told("velocity_nm_ps=[1, 0, 0]"),
      HasSubstr("atom 0 is 0.560109 nm from anchor 6 at 0.06011 ps, and the bonds between them reach"));
}

}  // namespace
}  // namespace taut::motions_tests
