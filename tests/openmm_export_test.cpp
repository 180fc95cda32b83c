// OpenMM's XML as taut writes it, read back: every number of every term. Needs no OpenMM.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <concepts>

#include "error_message.hpp"
#include "forcefield/force_field.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::openmm_export_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

OpenMMInput read_back(const OpenMMInput& input) {
  const TemporaryFolder folder;
  write_openmm(input, folder.path() / "a");
  return read_openmm(folder.path() / "a.system.xml", folder.path() / "a.state.xml");
}

// All there is of it, a number after the other; before each list, how long it is.
class Numbers {
 public:
  explicit Numbers(const OpenMMInput& input) {
    const Terms& t = input.terms;
    add(input.system.mass, input.start.box.edge, input.start.x, input.start.v, input.start.t,
        input.remove_momentum_every, input.has_velocities);
    list(input.system.bonds, [&](const auto& b) { add(b.i, b.j, b.length); });
    list(t.bonds, [&](const auto& b) { add(b.i, b.j, b.length, b.k); });
    list(t.angles, [&](const auto& a) { add(a.i, a.j, a.k, a.angle, a.stiffness); });
    list(t.cosine_angles, [&](const auto& a) { add(a.i, a.j, a.k, a.stiffness); });
    list(t.cosine_squared_angles, [&](const auto& a) { add(a.i, a.j, a.k, a.cosine, a.stiffness); });
    list(t.tabulated_bonds, [&](const auto& b) { add(b.i, b.j), add_table(*b.energy); });
    list(t.tabulated_angles, [&](const auto& a) { add(a.i, a.j, a.k), add_table(*a.energy); });
    list(t.torsions, [&](const auto& a) { add(a.i, a.j, a.k, a.l, a.periodicity, a.phase, a.amplitude); });
    list(t.rb_torsions,
         [&](const auto& a) { add(a.i, a.j, a.k, a.l, a.c[0], a.c[1], a.c[2], a.c[3], a.c[4], a.c[5]); });
    list(t.harmonic_torsions, [&](const auto& a) { add(a.i, a.j, a.k, a.l, a.angle, a.stiffness); });
    list(t.maps, [&](const auto& map) { add(map); });
    list(t.cmaps, [&](const auto& c) {
      for (int a = 0; a < 4; ++a) add(c.phi[a], c.psi[a]);
      add(c.map);
    });
    list(t.fene, [&](const auto& b) { add(b.i, b.j, b.k, b.r0); });
    list(t.pulls, [&](const auto& p) { add(p.atom, p.force); });
    list(t.restraints, [&](const auto& r) { add(r.atom, r.at, r.k, r.axes, r.free, r.side, r.takes_image); });
    add(t.gravity.value_or(Vec3::Constant(kNone)));
    if (t.nonbonded) add_nonbonded(*t.nonbonded);
    if (t.wca) {
      add(t.wca->sigma, t.wca->epsilon);
      list(t.wca->exclusions, [&](const auto& pair) { add(pair[0], pair[1]); });
    }
    if (t.tabulated_pairs) {
      list(t.tabulated_pairs->kind, [&](int kind) { add(kind); });
      list(t.tabulated_pairs->potentials, [&](const auto& p) { add(p.one, p.two), add_table(*p.energy); });
      list(t.tabulated_pairs->exclusions, [&](const auto& pair) { add(pair[0], pair[1]); });
    }
  }
  const std::vector<double>& all() const { return all_; }

 private:
  static constexpr double kNone = -12345;

  void add_table(const Spline& table) {
    add(table.first(), table.last());
    list(table.values(), [&](double v) { add(v); });
  }
  void add_nonbonded(const Nonbonded& n) {
    add(n.charge, n.sigma, n.epsilon, n.cutoff.value_or(kNone), n.switch_distance.value_or(kNone),
        n.rf_dielectric, n.dispersion_correction);
    list(n.exceptions, [&](const auto& e) { add(e.i, e.j, e.charge_product, e.sigma, e.epsilon); });
  }
  void list(const auto& terms, auto use) {
    add(terms.size());
    for (const auto& term : terms) use(term);
  }
  void add(const auto&... values) { (put(values), ...); }
  template <class Derived>
  void put(const Eigen::DenseBase<Derived>& values) {
    add(values.size());
    for (Eigen::Index k = 0; k < values.size(); ++k) all_.push_back(values.derived().data()[k]);
  }
  void put(std::integral auto value) { all_.push_back(static_cast<double>(value)); }
  void put(double value) { all_.push_back(value); }

  std::vector<double> all_;
};

void expect_read_back(const OpenMMInput& input) {
  EXPECT_EQ(Numbers(read_back(input)).all(), Numbers(input).all());
}

// Every force taut has, as OpenMM 8.6 gave it.
OpenMMInput every_force() {
  return read_openmm(TAUT_TEST_DATA "/every-force.system.xml", TAUT_TEST_DATA "/every-force.state.xml");
}

TEST(OpenMMExport, IsReadBackToTheLastBit) {
  const OpenMMInput input = every_force();
  const Terms& t = input.terms;
  for (const std::size_t terms : {t.bonds.size(), t.angles.size(), t.torsions.size(), t.rb_torsions.size(),
                                  t.harmonic_torsions.size(), t.maps.size(), t.cmaps.size(), t.fene.size(),
                                  t.pulls.size(), t.nonbonded->exceptions.size(), t.wca->exclusions.size()})
    EXPECT_GT(terms, 0u);
  EXPECT_TRUE(t.gravity && t.nonbonded->switch_distance && input.remove_momentum_every > 0);
  expect_read_back(input);
}

// A third of a nanometre has no short decimals.
TEST(OpenMMExport, IsReadBackToTheLastBitOfEveryNumber) {
  OpenMMInput input = every_force();
  input.start.x /= 3;
  input.start.v *= 1e-9 / 3;
  input.start.t = 1e7 / 3;
  input.start.box.edge *= 4.0 / 3;
  for (auto& bond : input.terms.bonds) bond.k *= 1e4 / 3;
  input.terms.cosine_angles = {{0, 1, 2, 7.0 / 3}};
  input.terms.cosine_squared_angles = {{0, 1, 2, -0.1 / 3, 7.0 / 3}};
  const auto table = [](double last, double value) {
    return std::make_shared<const Spline>("table", 0.01 / 3, last,
                                          std::vector{1 / value, value, 0.0, -7 / value});
  };
  const auto wide = table(9, 3), wider = table(10, 7), bend = table(3.2, 11);
  input.terms.tabulated_bonds = {{0, 1, wide}, {1, 2, wide}, {2, 3, wider}};
  input.terms.tabulated_angles = {{0, 1, 2, bend}, {3, 2, 1, bend}};
  expect_read_back(input);
}

TEST(OpenMMExport, IsReadBackHoweverPairsAreCutOff) {
  OpenMMInput input = every_force();
  Nonbonded& pairs = *input.terms.nonbonded;
  pairs.dispersion_correction = false;
  expect_read_back(input);
  pairs.switch_distance.reset();
  pairs.rf_dielectric = 3;
  expect_read_back(input);
  input.start.box = {};
  expect_read_back(input);
  pairs.cutoff.reset();
  expect_read_back(input);
}

// Lennard-Jones by a table goes into a force of its own, whose numbers are found again but for rounding.
TEST(OpenMMExport, IsReadBackWithATableOfTypes) {
  OpenMMInput input = every_force();
  Nonbonded& pairs = *input.terms.nonbonded;
  pairs.epsilon.setZero();
  LennardJonesTable table{{}, Eigen::MatrixXd(2, 2), Eigen::MatrixXd(2, 2)};
  for (int a = 0; a < input.system.atoms(); ++a) table.type.push_back(a % 2);
  table.a << 1e-6, 3e-6, 3e-6, 0;
  table.b << 2e-3, 0, 0, 5e-3;
  pairs.lj_table = table;
  const Nonbonded back = *read_back(input).terms.nonbonded;
  ASSERT_TRUE(back.lj_table);
  EXPECT_EQ(back.lj_table->type, table.type);
  EXPECT_LT((back.lj_table->a - table.a).norm(), 1e-14 * table.a.norm());
  EXPECT_LT((back.lj_table->b - table.b).norm(), 1e-14 * table.b.norm());
  EXPECT_EQ(back.switch_distance, pairs.switch_distance);
  EXPECT_EQ(back.dispersion_correction, pairs.dispersion_correction);
  EXPECT_EQ(back.exceptions.size(), pairs.exceptions.size());
}

// Three kinds, of which the last has no table.
TEST(OpenMMExport, IsReadBackWithTablesOfPairs) {
  OpenMMInput input = every_force();
  const auto table = [](double first, double last, double value) {
    return std::make_shared<const Spline>("table", first, last,
                                          std::vector{1 / value, value, -7 / value, 0.0});
  };
  TabulatedPairs& pairs = input.terms.tabulated_pairs.emplace();
  for (int a = 0; a < input.system.atoms(); ++a) pairs.kind.push_back(a % 3);
  pairs.potentials = {{0, 0, table(0.1, 0.5, 3)}, {0, 1, table(0.02, 1.0 / 3, 7)}};
  pairs.exclusions = {{0, 2}, {4, 1}};
  expect_read_back(input);
  EXPECT_THAT(read_back(input).notes, testing::Contains(HasSubstr("is zero nearer than its tables begin")));
}

// As taut's own scenes have them, of a file or built.
TEST(OpenMMExport, EverySceneComesBackWithItsForces) {
  for (const char* name : {"decane", "melt", "pair", "water_cluster"}) {
    SCOPED_TRACE(name);
    const OpenMMInput input = openmm_input(read_scene(find_scene(name)));
    expect_read_back(input);
  }
}

TEST(OpenMMExport, IsReadBackWithRestraintsOfEveryShape) {
  OpenMMInput input = every_force();
  const Vec3 z(0, 0, 1), x_and_y(1, 1, 0), all = Vec3::Ones();
  for (const Restraint& one :
       {Restraint{1, Vec3(0.1, 0.2, 0.3), 50}, Restraint{2, 0.4 * z, 70, z},
        Restraint{3, 0.4 * x_and_y, 70, x_and_y, 0.1}, Restraint{4, 0.4 * all, 70, all, 0.1, 0, false},
        Restraint{5, 0.4 * z, 9, z, 0, 1, false}, Restraint{6, 0.4 * z, 9, z, 0, -1, false},
        Restraint{7, -0.4 * z, 9, z, 0.2, 0, false}})
    input.terms.restraints.push_back(one);
  expect_read_back(input);
}

TEST(OpenMMExport, ForeignExpressionsAreRefused) {
  const TemporaryFolder folder;
  const std::string text = openmm_system_xml(every_force());
  for (const auto& [from, to] :
       {std::pair("1-(r/r0)^2", "1-(r/r0)^3"), {"-mass*(gx", "-mass*(x*gx"}, {"4*epsilon", "3*epsilon"}}) {
    std::string changed = text;
    const auto at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    changed.replace(at, std::string(from).size(), to);
    EXPECT_THAT(error_message([&] {
                  read_openmm(folder.write("a.system.xml", changed),
                              folder.write("a.state.xml", openmm_state_xml(every_force())));
                }),
                AllOf(HasSubstr("has the energy"), Not(HasSubstr("\n"))));
  }
}

TEST(OpenMMExport, SaysWhatOpenMMCannotExpress) {
  EXPECT_THAT(error_message([&] { openmm_system_xml(openmm_input(read_scene(find_scene("pendulum")))); }),
              AllOf(HasSubstr("OpenMM cannot express it"), HasSubstr("anchor"), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace taut::openmm_export_tests
