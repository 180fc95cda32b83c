// Water of four and five sites: its numbers, its start, its pressure, and runs with it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kept_state.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "pressure_of.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/start_file.hpp"
#include "temporary_folder.hpp"

namespace taut::water_models_tests {
namespace {

Scene water_of(const std::string& model, std::vector<std::string> more = {}) {
  more.push_back("build.model=" + model);
  return scene_of("water", more);
}

// What the papers say of each: OH, HOH, and where the charges are.
struct Published {
  const char* name;
  double oh, hoh, charge_h, site, sites_angle;
};
constexpr Published kPublished[] = {{"tip4pew", 0.09572, 104.52, 0.52422, 0.0125, 0},
                                    {"tip4p2005", 0.09572, 104.52, 0.5564, 0.01546, 0},
                                    {"opc", 0.08724, 103.6, 0.6791, 0.01594, 0},
                                    {"tip5p", 0.09572, 104.52, 0.241, 0.070, 109.47}};

double degrees(const Vec3& a, const Vec3& b) {
  return std::acos(a.normalized().dot(b.normalized())) * 180 / std::numbers::pi;
}

TEST(WaterModels, HaveTheirShapeAndCharges) {
  for (const auto& [name, oh, hoh, charge_h, distance, sites_angle] : kPublished) {
    SCOPED_TRACE(name);
    const Scene scene = water_of(name);
    const int each = sites_angle > 0 ? 5 : 4;
    ASSERT_EQ(scene.system.atoms(), 216 * each);
    EXPECT_EQ(scene.system.bond_count(), 216 * 3);
    EXPECT_EQ(scene.terms.nonbonded->exceptions.size(), 216u * each * (each - 1) / 2);
    const Eigen::VectorXd& q = scene.terms.nonbonded->charge;
    EXPECT_EQ(q[each], 0);
    EXPECT_NEAR(q[each + 1], charge_h, 5e-5);
    EXPECT_NEAR(q.segment(each, each).sum(), 0, 1e-15);
    const auto& x = scene.start.x;
    const int o = 5 * each;
    const Vec3 h1 = x.col(o + 1) - x.col(o), h2 = x.col(o + 2) - x.col(o), s = x.col(o + 3) - x.col(o);
    EXPECT_NEAR(h1.norm(), oh, 4e-6);
    EXPECT_NEAR(degrees(h1, h2), hoh, 2e-3);
    EXPECT_NEAR(s.norm(), distance, 5e-7);
    if (each == 4) {
      EXPECT_LT(degrees(s, h1 + h2), 1e-5);
      continue;
    }
    const Vec3 t = x.col(o + 4) - x.col(o);
    EXPECT_NEAR(t.norm(), distance, 1e-12);
    EXPECT_NEAR(degrees(s, t), sites_angle, 1e-9);
    EXPECT_NEAR(degrees(-s - t, h1 + h2), 0, 1e-5);
    EXPECT_NEAR((s - t).normalized().dot(h1), 0, 1e-12);
  }
}

// From the three-site start: O where it was; from its own final start: all as it was, and tiled.
TEST(WaterModels, StartFromWaterOfAnyModel) {
  const Scene three = scene_of("water"), five = water_of("tip5p");
  for (int m = 0; m < 216; ++m) EXPECT_EQ(Vec3(five.start.x.col(5 * m)), Vec3(three.start.x.col(3 * m)));
  const TemporaryFolder folder;
  const auto file = folder.write("s.toml", "");
  write_start(file, five.start);
  const std::string from = "build.start=" + file.string();
  EXPECT_LT((water_of("tip5p", {from}).start.x - five.start.x).cwiseAbs().maxCoeff(), 1e-14);
  const Scene eight = water_of("tip4pew", {from, "build.molecules=1728"});
  EXPECT_EQ(eight.system.atoms(), 1728 * 4);
  EXPECT_TRUE(eight.notes.empty());
  EXPECT_LT(bond_errors(eight.system, eight.start.x).max, 1e-12);
}

// Sites are where their parents are when a row or a frame is written, and move with them.
TEST(WaterModels, SitesFollowTheirParents) {
  for (const char* method : {"newton", "feedforward", "baumgarte", "rattle", "settle", "lincs"}) {
    Simulation simulation(water_of("tip5p", {"run.steps=20", std::string("method.name=") + method}));
    const Vectors start = simulation.state().x;
    simulation.run([](const Record&) {});
    const State s = simulation.state_to_write();
    const System& sys = simulation.scene().system;
    Vectors x = s.x, v = s.v;
    place_sites(sys.sites, x);
    EXPECT_EQ(x, s.x) << method;
    EXPECT_GT((x.col(3) - start.col(3)).norm(), 1e-3);
    const double h = 1e-6;  // a little later
    Vectors later = s.x + h * s.v;
    place_sites(sys.sites, later);
    EXPECT_LT((later - s.x - h * s.v).norm(), 1e-8);
    EXPECT_GT(v.col(3).norm(), 0.01);
    EXPECT_TRUE(simulation.state().v.col(3).isZero(0));
  }
}

// Constraint forces, handed forces and kinetic energy make the pressure of the centres: see pressure_test.
TEST(WaterModels, PressureIsThatOfTheCentres) {
  for (const char* model : {"tip4pew", "tip5p"}) {
    const Scene scene = water_of(model, {"forcefield.switch_nm=0.75", "forcefield.rf_dielectric=1e9"});
    const int each = scene.system.atoms() / 216;
    const auto energy = [&](double scale) {
      const System& sys = scene.system;
      State s = scene.start;
      s.box = s.box.scaled(Vec3::Constant(scale));
      for (int o = 0; o < sys.atoms(); o += each) {
        const Vec3 centre = s.x.middleCols<3>(o) * sys.mass.segment<3>(o) / sys.mass.segment<3>(o).sum();
        s.x.middleCols<3>(o).colwise() += (scale - 1) * centre;
      }
      ForceField forces(sys, s.box, scene.terms);
      return forces.evaluate_energy(sys, s);
    };
    const double step = 1e-6, slope = (energy(1 + step) - energy(1 - step)) / (2 * step);
    State at_rest = scene.start;
    at_rest.v.setZero();
    ForceField forces(scene.system, scene.start.box, scene.terms);
    const double pressure = tests::pressure_of(scene.system, forces, at_rest).trace() / 3;
    EXPECT_NEAR(pressure, -kBarPerUnit * slope / (3 * scene.start.box.volume()), 0.05) << model;
    EXPECT_GT(std::abs(pressure), 100);
  }
}

// Water of a number that no box was equilibrated of: it stays as warm as it is drawn.
TEST(WaterModels, CutFromABoxDoNotHeat) {
  for (const char* shape : {"build.box=cube", "build.box=dodecahedron"}) {
    Simulation simulation(
        scene_of("water", {shape, "build.molecules=350", "forcefield.cutoff_nm=0.8",
                           "forcefield.switch_nm=0.7", "run.steps=400", "run.log_every=20"}));
    double kelvin = 0;
    int rows = 0;
    simulation.run([&](const Record& row) { kelvin += row.temperature, ++rows; });
    EXPECT_NEAR(kelvin / rows, 298.15, 20) << shape;
  }
}

// Stopped, kept and gone on with by another simulation: the run that never stopped, to the last bit.
TEST(WaterModels, GoOnWhereTheyWereStopped) {
  for (const char* method : {"newton", "feedforward", "baumgarte"}) {
    const Scene scene = water_of("tip5p", {"run.steps=25", "forcefield.coulomb=pme", "run.thermostat_ps=0.1",
                                           std::string("method.name=") + method});
    SCOPED_TRACE(method);
    expect_to_go_on_from(scene, 13);
  }
}

TEST(WaterModels, MinimiseWithTheirSites) {
  Simulation simulation(water_of("tip4pew", {"run.minimise=true", "run.minimise_force_kj_mol_nm=600"}));
  const auto& report = simulation.start_report();
  ASSERT_TRUE(report.minimised);
  EXPECT_LT(report.minimised->largest_force, 600);
  EXPECT_LT(report.minimised->energy, report.minimised->energy_before);
}

}  // namespace
}  // namespace taut::water_models_tests
