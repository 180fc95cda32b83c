// Bonds that end in virtual sites, which link rigid bodies, beside an own solution of the equations of motion.

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/lincs.hpp"
#include "constraints/methods/settle.hpp"
#include "constraints/metric_potential.hpp"
#include "constraints/projection.hpp"
#include "constraints/redundancy.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "kept_state.hpp"
#include "md/observables.hpp"
#include "pressure_of.hpp"

namespace taut::linked_bodies_tests {
namespace {

using tests::NoForce, tests::Start;

// Two rods, 0-1 and 2-3, a plate 4-5-6 and a bead 12. The rods are linked by a site beyond the end of the first, 7, and one
// within the second, 8; the plate's site 10 to one beyond the end of the second, 11, whose parent 9 is a site, and to
// the bead.
const VirtualSites kSites = {
    VirtualSite::average(7, {{0, -0.2}, {1, 1.2}}), VirtualSite::average(8, {{2, 0.7}, {3, 0.3}}),
    VirtualSite::average(9, {{2, -0.3}, {3, 1.3}}), VirtualSite::average(10, {{4, 0.5}, {5, 0.3}, {6, 0.2}}),
    VirtualSite::average(11, {{9, 0.5}, {3, 0.5}})};
constexpr int kAtoms = 13;
const std::vector<std::array<int, 2>> kBonds = {{0, 1}, {2, 3}, {4, 5},   {5, 6},
                                                {6, 4}, {7, 8}, {11, 10}, {10, 12}};

// The same bonds as sums over atoms with mass, r = Σ c x, worked out by hand.
using Row = std::map<int, double>;
const std::vector<Row> kRows = {{{0, -1}, {1, 1}},
                                {{2, -1}, {3, 1}},
                                {{4, -1}, {5, 1}},
                                {{5, -1}, {6, 1}},
                                {{6, -1}, {4, 1}},
                                {{0, 0.2}, {1, -1.2}, {2, 0.7}, {3, 0.3}},
                                {{2, 0.15}, {3, -1.15}, {4, 0.5}, {5, 0.3}, {6, 0.2}},
                                {{4, -0.5}, {5, -0.3}, {6, -0.2}, {12, 1}}};

Eigen::VectorXd masses() {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(kAtoms);
  mass << 3, 5, 4, 2, 1, 2, 3, 0, 0, 0, 0, 0, 2;
  return mass;
}

// M a = F + Σ λ c r, with λ from the second derivative of each r² = d², by a dense solve; integrated by Runge and
// Kutta's method.
struct Exact {
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(std::ssize(kRows), kAtoms);
  Eigen::VectorXd inv_mass = masses().unaryExpr([](double m) { return m > 0 ? 1 / m : 0; });
  double spring = 0;  // F = −spring x
  Vectors x, v;

  Exact(const Vectors& its_x, const Vectors& its_v) : x(its_x), v(its_v) {
    for (std::size_t k = 0; k < kRows.size(); ++k)
      for (const auto& [a, weight] : kRows[k]) c(static_cast<Eigen::Index>(k), a) = weight;
  }
  Vectors forces(const Vectors& at) const {
    return -spring * at * (inv_mass.array() > 0).cast<double>().matrix().asDiagonal();
  }
  Eigen::MatrixXd matrix(const Vectors& at) const {
    const Vectors r = at * c.transpose();
    return (r.transpose() * r).cwiseProduct(c * inv_mass.asDiagonal() * c.transpose());
  }
  Eigen::VectorXd multipliers(const Vectors& at, const Vectors& rate) const {
    const Vectors r = at * c.transpose(), u = rate * c.transpose(),
                  a = forces(at) * inv_mass.asDiagonal() * c.transpose();
    const Eigen::VectorXd b = (r.cwiseProduct(a) + u.cwiseProduct(u)).colwise().sum().transpose();
    return matrix(at).fullPivLu().solve(-b);
  }
  Vectors accelerations(const Vectors& at, const Vectors& rate) const {
    const Vectors r = at * c.transpose();
    return (forces(at) + r * multipliers(at, rate).asDiagonal() * c) * inv_mass.asDiagonal();
  }
  void advance(double h) {
    const Vectors a = accelerations(x, v), q = v + h / 2 * a;
    const Vectors b = accelerations(x + h / 2 * v, q), p = v + h / 2 * b;
    const Vectors e = accelerations(x + h / 2 * q, p), w = v + h * e;
    const Vectors g = accelerations(x + h * p, w);
    x += h / 6 * (v + 2 * q + 2 * p + w);
    v += h / 6 * (a + 2 * b + 2 * e + g);
  }
};

struct Spring : ForceLaw {
  explicit Spring(double its_k) : k(its_k) {}
  double k;
  void evaluate(const System& sys, State& s) override {
    for (int a = 0; a < sys.atoms(); ++a)
      s.f.col(a) = sys.mass[a] > 0 ? Vec3(-k * s.x.col(a)) : Vec3(Vec3::Zero());
  }
};

struct Linked {
  System system;
  State state;
  Exact exact;

  Linked() : exact(places(), Vectors::Zero(3, kAtoms)) {
    std::vector<RigidBond> bonds;
    for (const auto& [i, j] : kBonds) bonds.push_back({i, j, (exact.x.col(i) - exact.x.col(j)).norm()});
    system = make_system(masses(), bonds, kSites);
    Random random(5);
    for (int a = 0; a < kAtoms; ++a)
      if (system.mass[a] > 0) exact.v.col(a) = random.normal_vector() / std::sqrt(system.mass[a]);
    const Vectors r = exact.x * exact.c.transpose(), u = exact.v * exact.c.transpose();
    const Eigen::VectorXd rates = r.cwiseProduct(u).colwise().sum().transpose();
    const Eigen::VectorXd g = exact.matrix(exact.x).fullPivLu().solve(rates);
    exact.v -= r * g.asDiagonal() * exact.c * exact.inv_mass.asDiagonal();
    state.x = exact.x;
    state.v = exact.v;
    state.f = Vectors::Zero(3, kAtoms);
  }
  static Vectors places() {
    Vectors x(3, kAtoms);
    x.setZero();
    x.col(0) << 0, 0, 0;
    x.col(1) << 1, 0.1, 0;
    x.col(2) << 1.5, 0.4, 0.3;
    x.col(3) << 1.9, 1.0, -0.1;
    x.col(4) << 2.4, 1.7, 0.2;
    x.col(5) << 2.8, 1.5, 0.9;
    x.col(6) << 3.2, 1.9, 0.4;
    x.col(12) << 3.1, 1.2, -0.2;
    place_sites(kSites, x);
    return x;
  }
};

double off(const Vectors& x, const Vectors& right) {
  double most = 0;
  for (int a = 0; a < kAtoms; ++a)
    if (masses()[a] > 0) most = std::max(most, (x.col(a) - right.col(a)).norm());
  return most;
}

struct Named {
  const char* name;
  MethodOptions options;
  double spread = 1e-7;  // from newton's positions
};
void PrintTo(const Named& named, std::ostream* out) {
  *out << named.name;
}
class LinkedBodies : public ::testing::TestWithParam<Named> {
 protected:
  static State after(const MethodOptions& options, double time, double h, double spring) {
    const Linked linked;
    State s = linked.state;
    Spring force(spring);
    const auto method = make_method(linked.system, options, h);
    const Dynamics dynamics{linked.system, force, *method};
    initialize(dynamics, h, s);
    for (int n = 0; n < std::lround(time / h); ++n) EXPECT_TRUE(step(dynamics, h, s).held());
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(By, LinkedBodies,
                         ::testing::Values(Named{"newton", default_options("newton")},
                                           Named{"mshake", default_options("mshake")},
                                           Named{"rattle", default_options("rattle")},
                                           Named{"shake", default_options("shake")},
                                           Named{"feedforward", default_options("feedforward"), 1e-5},
                                           Named{"baumgarte", default_options("baumgarte"), 1e-5},
                                           Named{"centred", Baumgarte::Options{.damping = "centred"}, 1e-3},
                                           Named{"swept", Baumgarte::Options{.sweeps = 100}, 1e-5},
                                           Named{"lincs", Lincs::Options{.order = 60, .iterations = 4}, 1e-5},
                                           Named{"settle", Settle::Options{.solute = "newton"}}),
                         [](const auto& test) { return test.param.name; });

// Free, and on springs to the origin.
TEST_P(LinkedBodies, MoveAsTheirEquationsOfMotionSayToSecondOrder) {
  for (const double spring : {0.0, 2.0}) {
    Exact exact = Linked().exact;
    exact.spring = spring;
    for (int n = 0; n < 500; ++n) exact.advance(0.002);
    const double coarse = off(after(GetParam().options, 1, 0.01, spring).x, exact.x);
    const double fine = off(after(GetParam().options, 1, 0.005, spring).x, exact.x);
    EXPECT_LT(fine, 2e-4) << spring;
    EXPECT_NEAR(coarse / fine, 4, 0.3) << spring;
  }
}

TEST_P(LinkedBodies, AreHeldAlikeByAllMethods) {
  const State newton = after(default_options("newton"), 1, 0.01, 2),
              by = after(GetParam().options, 1, 0.01, 2);
  EXPECT_LT(off(by.x, newton.x), GetParam().spread);
  EXPECT_LT(bond_errors(Linked().system, by.x).max, GetParam().spread);
}

TEST(BondsOfSites, HaveTheMultipliersThePressureAndTheMomentaOfTheExactMotion) {
  const Linked linked;
  const Exact& exact = linked.exact;
  State s = linked.state;
  const Eigen::VectorXd lambda = Projector(linked.system).multipliers(linked.system, s);
  EXPECT_LT((lambda - exact.multipliers(s.x, s.v)).norm(), 1e-12 * lambda.norm());
  s.box.edge = {7, 8, 9};
  ForceField forces(linked.system, s.box, {});
  const Vectors ma = exact.accelerations(s.x, s.v) * masses().asDiagonal();
  const Eigen::Matrix3d right = s.v * masses().asDiagonal() * s.v.transpose() + s.x * ma.transpose();
  const Eigen::Matrix3d found = tests::pressure_of(linked.system, forces, s) * (7 * 8 * 9) / kBarPerUnit;
  EXPECT_LT((found - right).norm(), 1e-12 * right.norm());

  const auto spin = [&](const State& at) {
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < kAtoms; ++a) sum += masses()[a] * at.x.col(a).cross(at.v.col(a));
    return sum;
  };
  NoForce none;
  const auto method = make_method(linked.system, default_options("newton"), 0.01);
  const Dynamics dynamics{linked.system, none, *method};
  State now = linked.state;
  initialize(dynamics, 0.01, now);
  double least = HUGE_VAL, most = 0;
  for (int n = 0; n < 5000; ++n) {
    ASSERT_TRUE(step(dynamics, 0.01, now).held());
    const double energy = kinetic_energy(linked.system, now.v);
    least = std::min(least, energy), most = std::max(most, energy);
  }
  EXPECT_LT((momentum(linked.system, now.v) - momentum(linked.system, linked.state.v)).norm(), 1e-10);
  EXPECT_LT((spin(now) - spin(linked.state)).norm(), 1e-9);
  const double start = kinetic_energy(linked.system, linked.state.v);
  EXPECT_LT(most - least, 2e-3 * start);
  EXPECT_LT(std::abs(kinetic_energy(linked.system, now.v) - start), 1e-3 * start);
}

TEST(BondsOfSites, WeighShapesByTheDeterminantOfTheirMatrix) {
  const Linked linked;
  const auto plainly = [&](const Vectors& x) { return 0.5 * std::log(linked.exact.matrix(x).determinant()); };
  MetricPotential metric(linked.system);
  Vectors f = Vectors::Zero(3, kAtoms), unused = f;
  EXPECT_NEAR(metric.add_forces(linked.state.x, 2.5, f), 2.5 * plainly(linked.state.x), 1e-11);
  for (int a = 0; a < kAtoms; ++a)
    for (int d = 0; d < 3; ++d) {
      Vectors up = linked.state.x, down = up;
      up(d, a) += 1e-5, down(d, a) -= 1e-5;
      EXPECT_NEAR(f(d, a), 2.5 * (plainly(down) - plainly(up)) / 2e-5, 1e-8);
    }
}

// Bonds that follow from others are those of a site to its own body, and a fourth between two plates that three hold.
TEST(BondsOfSites, CountByTheirRank) {
  const Linked linked;
  const Vectors& x = linked.state.x;
  EXPECT_TRUE(find_redundancy(linked.system, x).none());
  const auto with = [&](const std::vector<std::array<int, 2>>& more) {
    std::vector<RigidBond> bonds = linked.system.bonds;
    for (const auto& [i, j] : more) bonds.push_back({i, j, (x.col(j) - x.col(i)).norm()});
    return make_system(masses(), bonds, kSites);
  };
  for (const auto& [more, too_many] :
       std::vector<std::pair<std::vector<std::array<int, 2>>, int>>{{{{7, 0}}, 1},
                                                                    {{{10, 4}, {10, 5}}, 2},
                                                                    {{{8, 11}, {8, 3}}, 2},
                                                                    {{{7, 2}}, 0},
                                                                    {{{0, 11}, {4, 12}}, 0}}) {
    const System sys = with(more);
    const Redundancy found = find_redundancy(sys, x);
    EXPECT_EQ(std::ssize(found.redundant), too_many) << more[0][0] << '-' << more[0][1];
    EXPECT_TRUE(found.degenerate.empty());
    EXPECT_EQ(found.rank(sys), sys.bond_count() - too_many);
  }
  // the force is what it was, shared by all
  const System sys = with({{7, 0}});
  const Redundancy found = find_redundancy(sys, x);
  const System kept = without(sys, found.redundant);
  State s = linked.state;
  const Eigen::VectorXd alone = Projector(kept).multipliers(kept, s);
  const Eigen::VectorXd shared = least_norm_multipliers(sys, x, found.redundant, alone);
  const auto force = [&](const System& of, const Eigen::VectorXd& lambda) {
    Vectors r(3, of.bond_count()), f = Vectors::Zero(3, kAtoms);
    bond_vectors(of, x, r);
    add_constraint_force(of, r, lambda, f);
    return f;
  };
  EXPECT_LT((force(sys, shared) - force(kept, alone)).norm(), 1e-12 * alone.norm());
  EXPECT_LT(shared.norm(), 0.99 * alone.norm());
}

}  // namespace
}  // namespace taut::linked_bodies_tests
