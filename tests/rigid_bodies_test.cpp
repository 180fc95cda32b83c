// Molecules that are rigid bodies, and virtual sites within molecules of a scene.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "scene_energy.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"

namespace taut::rigid_bodies_tests {
namespace {

using testing::HasSubstr;

// One rigid molecule; `shape` lists its coordinates, `masses` its atoms.
std::string rigid(const std::vector<Vec3>& shape, const std::vector<double>& masses,
                  const std::string& rows = "") {
  std::string atoms, x;
  for (std::size_t a = 0; a < shape.size(); ++a) {
    atoms += fmt::format("{{name = \"B{}\", mass_u = {}}},", a, masses[a]);
    x += fmt::format("[{}, {}, {}],", shape[a].x(), shape[a].y(), shape[a].z());
  }
  return fmt::format(
      "[molecule.body]\natoms = [{}]\ncoordinates_nm = [{}]\nrigid = true\n{}\n[[place]]\nmolecule = "
      "\"body\"\ncentres_nm = [[0, 0, 0]]\n[run]\ndt_fs = 0.01\nsteps = 10\n",
      atoms, x, rows);
}

struct Moments {
  double mass;
  Vec3 centre;
  Eigen::Matrix3d inertia;

  Moments(const Eigen::VectorXd& m, const Vectors& x) : mass(m.sum()), centre(x * m / mass) {
    const Vectors d = x.colwise() - centre;
    const Eigen::Matrix3d second = d * m.asDiagonal() * d.transpose();
    inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  }
};

struct Body {
  const char* name;
  std::vector<Vec3> shape;
  std::vector<double> masses;
  int frame;
};
std::ostream& operator<<(std::ostream& out, const Body& body) {
  return out << body.name;
}

const Body kBodies[] = {
    {"Rod", {{0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}}, {3, 10, 1}, 2},
    {"Plate", {{0, 0, 0}, {0.2, 0, 0}, {0.2, 0.3, 0}, {0, 0.3, 0}, {0.1, 0.1, 0}}, {3, 10, 1, 2, 0}, 3},
    {"PlateWithAChargeAbove", {{0, 0, 0}, {0.2, 0, 0.1}, {0.1, 0.3, 0}, {0.1, 0.1, 0.4}}, {3, 10, 1, 0}, 3},
    {"Lump", {{0, 0, 0}, {0.2, 0, 0}, {0, 0.3, 0}, {0, 0, 0.4}, {0.1, 0.1, 0.1}}, {3, 10, 1, 2, 0}, 4}};

class EveryBody : public testing::TestWithParam<Body> {};

TEST_P(EveryBody, HasTheMassTheCentreAndTheInertiaOfItsAtoms) {
  const Body& body = GetParam();
  const Scene scene = read(rigid(body.shape, body.masses));
  const auto n = std::ssize(body.shape);
  EXPECT_EQ(scene.system.atoms(), n + body.frame);
  EXPECT_EQ(scene.system.bond_count(), body.frame * (body.frame - 1) / 2);
  const Vectors x = scene.start.x;  // turned at random: the atoms where their sites are
  const Moments frame(scene.system.mass, x);
  Eigen::VectorXd masses = Eigen::Map<const Eigen::VectorXd>(body.masses.data(), n);
  const Moments atoms(masses, x.leftCols(n));
  EXPECT_NEAR(frame.mass, atoms.mass, 1e-12 * atoms.mass);
  EXPECT_LT((frame.centre - atoms.centre).norm(), 1e-14);
  EXPECT_LT((frame.inertia - atoms.inertia).norm(), 1e-13 * atoms.inertia.norm());
  for (int a = 0; a < n; ++a)  // the shape, which a turn leaves
    for (int b = 0; b < a; ++b)
      EXPECT_NEAR((x.col(a) - x.col(b)).norm(), (body.shape[a] - body.shape[b]).norm(), 1e-14) << a << b;
  // and its mirror image is another body
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); };
  if (n > 3) {
    EXPECT_NEAR(
        volume(x.col(1) - x.col(0), x.col(2) - x.col(0), x.col(3) - x.col(0)),
        volume(body.shape[1] - body.shape[0], body.shape[2] - body.shape[0], body.shape[3] - body.shape[0]),
        1e-15);
  }
}

// A force on one atom moves it by ½t²(F/M + (I⁻¹(r × F)) × r).
TEST_P(EveryBody, TurnsByItsInertiaWhereAForceActs) {
  const Body& body = GetParam();
  const Scene scene = read(rigid(body.shape, body.masses, "pulls = [[1, 30, -20, 50]]"));
  const auto n = std::ssize(body.shape);
  const Vec3 force(30, -20, 50);
  const Vectors x = scene.start.x.leftCols(n);
  const Moments atoms(Eigen::Map<const Eigen::VectorXd>(body.masses.data(), n), x);
  const Vec3 arm = x.col(1) - atoms.centre;
  const Vec3 spin = atoms.inertia.completeOrthogonalDecomposition().solve(arm.cross(force));
  Simulation simulation(scene);
  simulation.run({});
  const double t = simulation.state().t;
  for (int a = 0; a < n; ++a) {
    const Vec3 expected = 0.5 * t * t * (force / atoms.mass + spin.cross(Vec3(x.col(a) - atoms.centre)));
    const Vec3 moved = simulation.state().x.col(a) - x.col(a);
    EXPECT_LT((moved - expected).norm(), 1e-5 * expected.norm()) << a;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryBody, testing::ValuesIn(kBodies),
                         [](const auto& of) { return std::string(of.param.name); });

const SceneText kSites{R"(atom.A = {mass_u = 20, epsilon_kj_mol = 1, sigma_nm = 0.3}
atom.S = {mass_u = 0, epsilon_kj_mol = 1, sigma_nm = 0.3}
place = [{molecule = "rods", count = 5}]
build = {box_nm = 4}
forcefield = {cutoff_nm = 1, switch_nm = 0.8}
[molecule.rods]
atoms = ["A", "S", "A"]
units = 4
bonds = [[0, 2, 0.4], [2, 3, 0.3]]
virtual_sites2 = [[1, 0, 2, 0.25]]
)"};

TEST(SitesInMolecules, StandBetweenTheirParentsInEveryUnit) {
  const Scene scene = read(kSites.text);
  ASSERT_EQ(scene.system.sites.size(), 20u);
  EXPECT_EQ(scene.system.anchors(), 0);
  const Vectors& x = scene.start.x;
  for (const VirtualSite& site : scene.system.sites) {
    const int s = site.atom;
    EXPECT_LT((x.col(s) - (0.75 * x.col(s - 1) + 0.25 * x.col(s + 1))).norm(), 1e-14);
    EXPECT_NEAR((x.col(s + 1) - x.col(s - 1)).norm(), 0.4, 1e-12);
  }
}

TEST(SitesInMolecules, OfThreeParentsStandInAndOutOfTheirPlane) {
  const std::string text = R"([molecule.m]
atoms = [{name = "A", mass_u = 20}, {name = "A", mass_u = 20}, {name = "A", mass_u = 20}, {name = "S", mass_u = 0}, {name = "T", mass_u = 0}]
bonds = [[0, 1, 0.4], [1, 2, 0.4], [0, 2, 0.4]]
virtual_sites3 = [[3, 0, 1, 2, 0.2, 0.5]]
virtual_sites3out = [[4, 0, 1, 2, 0.2, 0.5, -1.5]]
[[place]]
molecule = "m"
count = 1
)";
  const Vectors x = read(text).start.x;
  const Vec3 r1 = x.col(1) - x.col(0), r2 = x.col(2) - x.col(0);
  const Vec3 in_plane = Vec3(x.col(0)) + 0.2 * r1 + 0.5 * r2;
  EXPECT_LT((x.col(3) - in_plane).norm(), 1e-14);
  EXPECT_LT((x.col(4) - (in_plane - 1.5 * r1.cross(r2))).norm(), 1e-14);
}

// A body of four points is written as local coordinates, whose forces are the same.
TEST(RigidBodies, GoToOpenMMAndBack) {
  const Body& lump = kBodies[3];
  const Scene scene = read(rigid(lump.shape, lump.masses, "pulls = [[1, 30, -20, 50], [4, 1, 2, 3]]"));
  const auto evaluated = [](const Scene& of) {
    State s = of.start;
    ForceField(of.system, s.box, of.terms).evaluate(of.system, s);
    return s;
  };
  const State here = evaluated(scene), there = evaluated(through_openmm(scene));
  EXPECT_LT((here.x - there.x).norm(), 1e-14);
  EXPECT_LT((here.f - there.f).norm(), 1e-12);
}

// The points that carry the mass of a rod do not repel, whose beads are all alike.
TEST(RigidBodies, RepelByTheirBeadsAlone) {
  const SceneText rods{
      R"(place = [{molecule = "rod", centres_nm = [[0.5, 0.5, 0.5], [0.7, 0.6, 0.6], [0.5, 0.8, 0.5]]}]
build = {box_nm = 4}
forcefield = {pair = "wca"}
run = {minimise = true, soft_start = true}
[molecule.rod]
atoms = [{name = "B", mass_u = 20, sigma_nm = 0.34, epsilon_kj_mol = 1}]
units = 3
rigid = true
coordinates_nm = [[0, 0, 0], [0.17, 0, 0], [0.34, 0, 0]]
)"};
  EXPECT_THAT(complaint(rods.with("sigma_nm = 0.34, epsilon_kj_mol = 1", "charge_e = 1").text),
              HasSubstr("forcefield.pair: wca repels by epsilon_kj_mol, which no atom has"));
  const Scene scene = read(rods.text);
  ASSERT_TRUE(scene.terms.wca);
  EXPECT_EQ(scene.terms.wca->without, (std::vector{3, 4, 8, 9, 13, 14}));
  State placed = scene.start;
  place_sites(scene.system.sites, placed.x);
  double expected = 0;
  for (int a = 0; a < 15; ++a)
    for (int b = a + 1; b < 15; ++b) {
      const double r = (placed.x.col(b) - placed.x.col(a)).norm(), six = std::pow(0.34 / r, 6);
      if (a / 5 != b / 5 && a % 5 < 3 && b % 5 < 3 && six > 0.5) expected += 4 * (six * six - six) + 1;
    }
  EXPECT_GT(expected, 1);
  EXPECT_NEAR(energy_of(scene), expected, 1e-9 * expected);

  const Scene back = through_openmm(scene);
  EXPECT_EQ(back.terms.wca->without, scene.terms.wca->without);
  EXPECT_NEAR(energy_of(back), expected, 1e-9 * expected);

  const Simulation parted(scene);
  EXPECT_GT(*parted.start_report().pushed_apart, 0);
  EXPECT_EQ(parted.dof().total(), 3 * 5 - 3);  // its momentum is conserved from rest
}

TEST(SitesInMolecules, BadOnesAreRefusedByName) {
  const char* sites = "virtual_sites2";
  expect_said(kSites,
              {{sites, sites, "no error"},
               {"mass_u = 0,", "mass_u = 3,", "virtual_sites2[0]: atom 1 is a virtual site of mass 3 u"},
               {"0.25]]", "0.25], [1, 2, 0, 0.5]]", "atom 1 is a virtual site already"},
               {"[[0, 2, 0.4]", "[[0, 1, 0.4]", "some parents of virtual sites are tied to no other atom"},
               {sites, "springs = [[1, 3, 0.3, 100]]\nvirtual_sites2", "no error"}});
}

TEST(SitesInMolecules, MayBeParents) {
  const SceneText chained = kSites.with("\"S\", \"A\"]\nunits = 4", "\"S\", \"A\", \"S\"]")
                                .with("[[0, 2, 0.4], [2, 3, 0.3]]", "[[0, 2, 0.4]]")
                                .with("[[1, 0, 2, 0.25]]", "[[1, 3, 2, 0.25], [3, 0, 2, 0.5]]");
  const Vectors x = read(chained.text).start.x;
  EXPECT_LT((x.col(3) - 0.5 * (x.col(0) + x.col(2))).norm(), 1e-15);
  EXPECT_LT((x.col(1) - (0.75 * x.col(3) + 0.25 * x.col(2))).norm(), 1e-15);
  EXPECT_THAT(complaint(chained.with("[3, 0, 2, 0.5]", "[3, 1, 2, 0.5]").text),
              HasSubstr("atom 1: its virtual site follows from itself"));
}

TEST(RigidBodies, BadOnesAreRefusedByName) {
  const Body& rod = kBodies[0];
  const std::string good = rigid(rod.shape, rod.masses);
  EXPECT_EQ(complaint(good), "no error");
  EXPECT_THAT(complaint(rigid(rod.shape, rod.masses, "bonds = [[0, 1, 0.3]]")),
              HasSubstr("molecule.body.bonds: has no effect"));
  EXPECT_THAT(complaint(rigid(rod.shape, {0, 0, 0})), HasSubstr("a rigid molecule needs atoms with mass"));
  EXPECT_THAT(complaint(rigid(rod.shape, {0, 1, 0})), HasSubstr("all mass of the rigid molecule is at one"));
  EXPECT_THAT(complaint(rigid({{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {1, 1, 0})),
              HasSubstr("atom 2 has no mass and is beside the line of those that have"));
  EXPECT_THAT(complaint(SceneText{good}.with("coordinates_nm", "#").text),
              HasSubstr("molecule.body.rigid: needs the shape: coordinates_nm, or file"));
}

}  // namespace
}  // namespace taut::rigid_bodies_tests
