// Positions that are no numbers, infinite or absurd, into every force: each says which atom it is, and is as
// it was when it is given good ones again.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "every_machine.hpp"
#include "force_checks.hpp"
#include "forcefield/bonded/cmap.hpp"
#include "forcefield/check_positions.hpp"

namespace taut::absurd_positions_tests {
namespace {

using namespace tests;

constexpr int kAtoms = 1000;  // so many terms that threads share them out
constexpr int kBad = 517;
const Box kBox{Vec3(4, 4.2, 4.4), Vec3(1, -1, 1.5)};

// A coil through a box, no four of its atoms in a plane.
Vectors coil() {
  Vectors x(3, kAtoms);
  for (int a = 0; a < kAtoms; ++a)
    x.col(a) = Vec3(0.5 * std::cos(0.8 * a), 0.5 * std::sin(0.8 * a), 0.02 * a + 0.05 * std::sin(2.1 * a));
  return x;
}

class Wall final : public OwnField {
 public:
  std::string name() const override { return "wall"; }
  double add(const Vectors& x, Vectors& f) override {
    EXPECT_TRUE(x.allFinite()) << "what somebody else wrote is given it, too";
    f.row(0) -= x.row(0);
    return 0.5 * x.row(0).squaredNorm();
  }
};

struct Given {
  Terms terms;
  Box box;
};

// Each force by itself, on every atom or on some.
std::map<std::string, Given> every_force() {
  std::map<std::string, Given> all;
  Terms bonds, angles, torsions, rb, harmonic, cmaps, fene;
  cmaps.maps.emplace_back(Eigen::MatrixXd::Random(24, 24));
  for (int a = 0; a + 5 <= kAtoms; ++a) {
    bonds.bonds.push_back({a, a + 1, 0.3, 1000});
    angles.angles.push_back({a, a + 1, a + 2, 1.9, 100});
    torsions.torsions.push_back({a, a + 1, a + 2, a + 3, 3, 0.5, 4});
    rb.rb_torsions.push_back({a, a + 1, a + 2, a + 3, {1, 2, 3, 4, 5, 6}});
    harmonic.harmonic_torsions.push_back({a, a + 1, a + 2, a + 3, 1, 20});
    cmaps.cmaps.push_back({{a, a + 1, a + 2, a + 3}, {a + 1, a + 2, a + 3, a + 4}, 0});
    fene.fene.push_back({a, a + 1, 1000, 1.5});
  }
  all["bonds"] = {bonds, {}};
  all["angles"] = {angles, {}};
  all["torsions"] = {torsions, {}};
  all["rb_torsions"] = {rb, {}};
  all["harmonic_torsions"] = {harmonic, {}};
  all["cmaps"] = {cmaps, {}};
  all["fene"] = {fene, {}};
  all["none"] = {{}, kBox};
  all["gravity"] = {{.gravity = Vec3(0, 0, -10)}, {}};
  all["pulls"] = {{.pulls = {{kBad, Vec3(1, 2, 3)}}}, {}};
  all["restraints"] = {{.restraints = {{kBad, Vec3(1, 2, 3), 100}}}, kBox};
  all["own"] = {{.own = {std::make_shared<Wall>()}}, {}};
  all["wca"] = {{.wca = Wca{0.1, 1, {}}}, {}};
  all["wca_in_a_box"] = {{.wca = Wca{0.1, 1, {}}}, kBox};

  Nonbonded pairs;
  pairs.charge = Eigen::VectorXd::LinSpaced(kAtoms, -0.5, 0.5);
  pairs.sigma = Eigen::VectorXd::Constant(kAtoms, 0.1);
  pairs.epsilon = Eigen::VectorXd::Constant(kAtoms, 0.5);
  Nonbonded some = pairs, exceptions = pairs;
  some.charge[kBad] = some.epsilon[kBad] = 0;
  exceptions.charge.setZero();
  exceptions.epsilon.setZero();
  for (int a = 0; a + 1 < kAtoms; ++a) exceptions.exceptions.push_back({a, a + 1, 0.5, 0.2, 0.3});
  const auto add = [&](const std::string& name, Nonbonded nb, const Box& box) {
    for (const Precision precision : {Precision::kDouble, Precision::kMixed})
      all[name + (precision == Precision::kMixed ? "_mixed" : "")] = {
          {.nonbonded = nb, .precision = precision}, box};
  };
  add("exceptions", exceptions, {});
  for (const auto& [name, nb] : {std::pair{"pairs", pairs}, std::pair{"pairs_of_others", some}}) {
    Nonbonded cut = nb, pme = nb;
    pme.cutoff = cut.cutoff = 0.9;
    pme.pme = PmeParameters{.alpha = 3, .grid = {24, 25, 27}};
    add(name, nb, {});
    add(name + std::string("_cut"), cut, {});
    add(name + std::string("_in_a_box"), cut, kBox);
    add(name + std::string("_pme"), pme, kBox);
  }
  return all;
}

Evaluated at(Bench& bench, const Vectors& x) {
  return bench.at(x);
}

TEST(AbsurdPositions, AreNamedBeforeAnyForceSeesThem) {
  const Vectors good = coil();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const auto& [name, given] : every_force()) {
    SCOPED_TRACE(name);
    const auto& [terms, box] = given;
    on_one_to_three_threads([&, &terms = terms, &box = box] {
      Bench bench(kAtoms, terms, box);
      const Evaluated before = at(bench, good);
      for (const double value : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e200, 1e160, 1e30, -1e17})
        for (int d = 0; d < 3; ++d) {
          SCOPED_TRACE(fmt::format("{} along {}", value, "xyz"[d]));
          Vectors bad = good;
          bad(d, kBad) = value;
          EXPECT_THAT(error_message<SimulationFailure>([&] { bench.at(bad); }),
                      testing::HasSubstr(fmt::format("atom {}", kBad)));
        }
      const Evaluated after = at(bench, good);
      EXPECT_LT((after.f - before.f).norm(), 1e-12 * before.f.norm() + 1e-12);
      EXPECT_NEAR(after.energy, before.energy, 1e-11 * std::abs(before.energy));
    });
  }
}

// Far off, but where numbers are still some: forces are numbers, or it is said who ran away.
TEST(AbsurdPositions, FarAwayGiveNumbersOrAFailure) {
  const Vectors good = coil();
  for (const auto& [name, given] : every_force()) {
    SCOPED_TRACE(name);
    for (const double value : {1e14, -1e12, 1e9, -1e6})
      for (int d = 0; d < 3; ++d) {
        SCOPED_TRACE(fmt::format("{} along {}", value, "xyz"[d]));
        Bench bench(kAtoms, given.terms, given.box);
        Vectors far = good;
        far(d, kBad) = value;
        try {
          const Evaluated there = bench.at(far);
          EXPECT_TRUE(there.f.allFinite());
          EXPECT_TRUE(std::isfinite(there.energy));
        } catch (const SimulationFailure& e) {
          EXPECT_FALSE(std::string(e.what()).empty());
        }
      }
  }
}

// Their own places count where they are placed, whatever they had before.
TEST(AbsurdPositions, OfParentsOfVirtualSitesAreNamed) {
  const System sys = make_system(
      Eigen::Vector<double, 6>(2, 2, 2, 0, 0, 0), {},
      {VirtualSite::average(3, {{0, 0.5}, {1, 0.5}}), VirtualSite::out_of_plane(4, 0, 1, 2, {0.3, 0.3, 2}),
       VirtualSite::local(5, {{0, 1, -1, -1}, {1, 0, 1, 0}, {2, 0, 0, 1}}, {0.1, 0.1, 0.1})});
  ForceField forces(sys, {}, {.gravity = Vec3(0, 0, -10)});
  State s;
  s.x = columns({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0.02}, {NAN, 0, 0}, {0, NAN, 0}, {0, 0, HUGE_VAL}});
  const State good = s;
  forces.evaluate(sys, s);
  EXPECT_TRUE(s.x.allFinite() && s.f.allFinite());
  for (const double value : {double(NAN), HUGE_VAL, 1e300, 1e100, -1e20})
    for (int parent = 0; parent < 3; ++parent) {
      s = good;
      s.x(1, parent) = value;
      EXPECT_THAT(error_message<SimulationFailure>([&] { forces.evaluate(sys, s); }),
                  testing::HasSubstr(fmt::format("atom {}", parent)))
          << value;
    }
}

// Also for those who ask a map itself.
TEST(CmapSurface, GivesNoNumberAtAnAngleThatIsNone) {
  const CmapSurface surface(Eigen::MatrixXd::Random(24, 24));
  for (const double angle : {double(NAN), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_TRUE(std::isnan(surface.at(angle, 1).energy));
    EXPECT_TRUE(std::isnan(surface.at(1, angle).energy));
  }
}

// Also where rounding has left them on both sides of a face of the box.
TEST(AtomsInOnePlace, AreNamedAcrossEachFaceOfTheBox) {
  for (int d = 0; d < 3; ++d) {
    Vectors x(3, 4);
    x.col(0) = Vec3(0.5, 0.6, 0.7);
    x.col(1) = Vec3(1.1, -0.4, 0.9) - 1e-12 * Vec3::Unit(d);
    x.col(1)[d] = 0;
    x.col(2) = Vec3(2, 2, 2);
    x.col(3) = x.col(1) + kBox.lattice_vector(Vec3::Unit(d)) - 1e-12 * Vec3::Unit(d);
    EXPECT_THAT(error_message([&] { refuse_atoms_in_one_place(kBox, x); }),
                testing::HasSubstr("atoms 1 and 3 are in one place"));
    EXPECT_NO_THROW(refuse_atoms_in_one_place(kBox, x.leftCols(3)));
  }
}

}  // namespace
}  // namespace taut::absurd_positions_tests
