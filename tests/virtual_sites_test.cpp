// Virtual sites: where they are, what they hand to their parents, and that all that counts atoms knows them.

#include "md/virtual_sites.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "error_message.hpp"
#include "force_checks.hpp"
#include "md/observables.hpp"
#include "simulation/temperatures.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut::virtual_sites_tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Atoms 0 to 3 are parents, 4 is the site, 5 a bystander; 6 and 7 are anchors, or sites between 4 and its parents.
struct Sample {
  const char* name;
  VirtualSites sites;
};
std::ostream& operator<<(std::ostream& out, const Sample& of) {
  return out << of.name;
}

const Vectors kPlaces = columns({{0.02, 0.1, -0.3},
                                 {0.3, 0, 0.05},
                                 {0.1, 0.25, 0},
                                 {-0.2, 0.1, 0.3},
                                 {0, 0, 0},
                                 {1, 0.6, 0.8},
                                 {0, 0, 0},
                                 {0, 0, 0}});

const VirtualSite kPlane = VirtualSite::out_of_plane(4, 1, 0, 3, {0.3, -0.5, 1.7}),
                  kLocal3 = VirtualSite::local(
                      4, {{0, 0.2, -1, 0.3}, {1, 0.7, 0.4, 0.5}, {2, 0.1, 0.6, -0.8}}, {0.2, -0.1, 0.3}),
                  kLocal4 = VirtualSite::local(
                      4, {{3, 0.4, 1, 0.3}, {1, 0.3, 0.4, 0.2}, {2, -0.1, -1.2, 0.5}, {0, 0.4, -0.2, -1}},
                      {-0.3, 0.2, 0.4});
// As atom 6, and as a parent of which atom 4 follows by way of atom 7.
VirtualSites chain_of(VirtualSite site) {
  site.atom = 6;
  return {VirtualSite::out_of_plane(4, 7, 2, 6, {0.4, 0.2, 1.1}), site,
          VirtualSite::average(7, {{6, 0.6}, {3, 0.4}})};
}

const Sample kSamples[] = {{"two", {VirtualSite::average(4, {{0, 0.3}, {1, 0.7}})}},
                           {"three", {VirtualSite::average(4, {{2, 0.8}, {1, 0.5}, {3, -0.3}})}},
                           {"plane", {kPlane}},
                           {"local3", {kLocal3}},
                           {"local4", {kLocal4}},
                           {"chain_of_plane", chain_of(kPlane)},
                           {"chain_of_local", chain_of(kLocal4)}};

System with(const VirtualSites& sites) {
  Eigen::VectorXd mass(8);
  mass << 12, 1, 2, 3, 0, 5, 0, 0;
  return make_system(mass, {}, sites);
}

// A spring from the site to each other atom, and a constant pull.
Terms springs() {
  Terms terms;
  for (const int a : {0, 1, 2, 3, 5}) terms.bonds.push_back({4, a, 0.1, 300.0 + a});
  terms.pulls.push_back({4, {7, -9, 4}});
  return terms;
}

class EveryKind : public ::testing::TestWithParam<Sample> {
 protected:
  Vectors placed(Vectors x) const {
    place_sites(GetParam().sites, x);
    return x;
  }
};
INSTANTIATE_TEST_SUITE_P(Sites, EveryKind, ::testing::ValuesIn(kSamples),
                         [](const auto& sample) { return sample.param.name; });

TEST_P(EveryKind, GivesItsParentsMinusTheSlopeOfTheEnergy) {
  const System sys = with(GetParam().sites);
  ForceField forces(sys, {}, springs());
  const auto at = [&](const Vectors& x) {
    State s{x, {}, {}, 0, {}};
    const double energy = forces.evaluate_energy(sys, s);
    return Evaluated{energy, s.f};
  };
  const Vectors f = at(kPlaces).f;
  EXPECT_TRUE(f.col(4).isZero(0));
  const double step = 1e-5, largest = f.cwiseAbs().maxCoeff();
  for (const int a : {0, 1, 2, 3, 5})
    for (int d = 0; d < 3; ++d) {
      Vectors up = kPlaces, down = kPlaces;
      up(d, a) += step;
      down(d, a) -= step;
      EXPECT_NEAR(f(d, a), (at(down).energy - at(up).energy) / (2 * step), 1e-7 * largest)
          << "atom " << a << ", axis " << d;
    }
}

TEST_P(EveryKind, HasTheVirialOfItsParents) {
  const System sys = with(GetParam().sites);
  Terms terms = springs();
  terms.pulls.clear();  // a field from outside has none
  ForceField forces(sys, {}, terms);
  const auto strained = [&](int a, int b, double by) {
    Eigen::Matrix3d strain = Eigen::Matrix3d::Identity();
    strain(a, b) += by;
    State s{strain * kPlaces, {}, {}, 0, {}};
    return forces.evaluate_energy(sys, s);
  };
  State s{kPlaces, {}, {}, 0, {}};
  ForceField::Evaluation evaluation;
  forces.evaluate(sys, s, evaluation);
  const Eigen::Matrix3d virial = forces.virial(s, evaluation);
  const double step = 1e-6;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      EXPECT_NEAR(virial(a, b), (strained(a, b, -step) - strained(a, b, step)) / (2 * step),
                  1e-7 * virial.norm());
}

TEST_P(EveryKind, MovesAsItsParentsMove) {
  Random random(1);
  Vectors v(3, 8);
  for (auto&& column : v.colwise()) column = random.normal_vector();
  const double step = 1e-6;
  const Vec3 slope = (placed(kPlaces + step * v) - placed(kPlaces - step * v)).col(4) / (2 * step);
  place_site_velocities(GetParam().sites, placed(kPlaces), v);
  EXPECT_LT((v.col(4) - slope).norm(), 1e-8);
}

// OpenMM's definitions, by hand: a right angle with sides along x and y.
TEST(VirtualSites, AreWhereOpenMMHasThem) {
  const Vectors parents = columns({{1, 1, 1}, {3, 1, 1}, {1, 2, 1}, {}});
  const auto at = [&](const VirtualSite& site) {
    Vectors x = parents;
    place_sites({site}, x);
    return Vec3(x.col(3));
  };
  EXPECT_EQ(at(VirtualSite::average(3, {{0, 0.25}, {1, 0.75}})), Vec3(2.5, 1, 1));
  EXPECT_EQ(at(VirtualSite::average(3, {{0, 0.5}, {1, 0.25}, {2, 0.25}})), Vec3(1.5, 1.25, 1));
  EXPECT_EQ(at(VirtualSite::out_of_plane(3, 0, 1, 2, {0.5, 0.25, 0.75})), Vec3(2, 1.25, 2.5));
  const VirtualSite local =
      VirtualSite::local(3, {{0, 1, -1, -1}, {1, 0, 1, 0.5}, {2, 0, 0, 0.5}}, {0.5, 0.25, -1});
  EXPECT_LT((at(local) - Vec3(1.5, 1.25, 0)).norm(), 1e-15);
}

TEST(VirtualSites, OfParentsInLineAreASimulationsFailure) {
  const VirtualSite site = VirtualSite::local(3, {{0, 1, -1, -1}, {1, 0, 1, 0}, {2, 0, 0, 1}}, {0, 0, 1});
  for (Vectors x :
       {columns({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {}}), columns({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {}})})
    EXPECT_THROW(place_sites({site}, x), SimulationFailure);
}

std::string refusal(const VirtualSites& sites, std::vector<RigidBond> bonds = {}) {
  Eigen::VectorXd mass(5);
  mass << 1, 1, 1, 0, 0;
  return error_message([&] { make_system(mass, std::move(bonds), sites); });
}

TEST(VirtualSites, ThatCannotBeAreRefused) {
  const VirtualSite good = VirtualSite::average(3, {{0, 0.5}, {1, 0.5}});
  EXPECT_EQ(refusal({good}), "no error");
  EXPECT_EQ(refusal({good}, {{2, 3, 0.1}}), "no error");
  EXPECT_THAT(refusal({good, good}), HasSubstr("atom 3: is a virtual site twice"));
  EXPECT_THAT(refusal({VirtualSite::average(2, {{0, 1}})}), HasSubstr("atom 2: a virtual site of mass 1 u"));
  EXPECT_THAT(refusal({VirtualSite::average(5, {{0, 1}})}), HasSubstr("atom 5 is out of range"));
  EXPECT_EQ(refusal({good, VirtualSite::average(4, {{0, 0.5}, {3, 0.5}})}), "no error");
  EXPECT_THAT(refusal({VirtualSite::average(3, {{0, 0.5}, {4, 0.5}}), VirtualSite::average(4, {{3, 1}})}),
              HasSubstr("atom 3: its virtual site follows from itself"));
  EXPECT_THAT(refusal({VirtualSite::average(3, {{3, 1}})}), HasSubstr("follows from itself"));
  EXPECT_THAT(refusal({VirtualSite::average(3, {{5, 1}})}), HasSubstr("has parent 5, expected one of"));
  EXPECT_THAT(refusal({VirtualSite::average(3, {{1, 0.5}, {1, 0.5}})}),
              HasSubstr("atom 1 as a parent twice"));
  EXPECT_THAT(refusal({VirtualSite::average(3, {{0, 0.5}, {1, 0.6}})}), HasSubstr("weights that add to 1.1"));
  EXPECT_THAT(refusal({VirtualSite::average(3, {})}), HasSubstr("has no parents"));
  EXPECT_THAT(refusal({VirtualSite::local(3, {{0, 1, 1, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}}, {1, 0, 0})}),
              HasSubstr("weights of its axes that add to 1 and 0"));
  EXPECT_THAT(refusal({VirtualSite::local(3, {{0, 1, 1, 1}, {1, 0, -1, 0}, {2, 0, 0, -1}}, {NAN, 0, 0})}),
              HasSubstr("finite"));
}

// Two atoms and their site, an atom, and an anchor.
TEST(VirtualSites, AreNoAnchorsAndHaveNoDegreesOfFreedom) {
  Eigen::VectorXd mass(4), with_anchor(5);
  mass << 1, 0, 3, 2;
  with_anchor << mass, 0;
  const VirtualSite site = VirtualSite::average(1, {{0, 0.5}, {2, 0.5}});
  const System sys = make_system(mass, {{0, 2, 0.1}}, {site});
  EXPECT_EQ(degrees_of_freedom(sys, 1, 3).total(), 9 - 1 - 3);
  EXPECT_TRUE(sys.is_site(1) && !sys.is_site(0) && !sys.is_anchor(1));
  const System anchored = make_system(with_anchor, {{0, 2, 0.1}}, {site});
  EXPECT_TRUE(anchored.is_anchor(4) && !anchored.is_site(4));
  EXPECT_EQ(degrees_of_freedom(anchored, 1, 0).total(), 9 - 1);

  EXPECT_THAT(molecules(4, bonded_pairs(sys, {})), ElementsAre(0, 0, 0, 1));
  const Vectors x = columns({{0, 0, 0}, {0.05, 0, 0}, {0.1, 0, 0}, {1, 1, 1}});
  const Temperatures of(sys, {}, x, true);
  EXPECT_EQ(of.types()[0].name, "1 molecule of 3 atoms");
  EXPECT_EQ(of.types()[0].dof, (std::array<double, 3>{3, 2, 0}));
}

}  // namespace
}  // namespace taut::virtual_sites_tests
