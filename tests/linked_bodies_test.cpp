// Bonds that end in virtual sites, which link rigid bodies, beside an own solution of the equations of motion.

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "base/statistics.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/lincs.hpp"
#include "constraints/metric_potential.hpp"
#include "constraints/projection.hpp"
#include "constraints/redundancy.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "kept_state.hpp"
#include "md/observables.hpp"
#include "pressure_of.hpp"
#include "scene_text.hpp"
#include "systems/openmm/export.hpp"

namespace taut::linked_bodies_tests {
namespace {

using testing::HasSubstr;
using tests::NoForce;

// Two rods, 0-1 and 2-3, a plate 4-5-6 and a bead 12. The rods are linked by a site beyond the end of the first, 7, and one
// within the second, 8; the plate's site 10 to one beyond the end of the second, 11, whose parent 9 is a site, and to
// the bead.
const VirtualSites kSites = {VirtualSite::average(7, {{0, -0.2}, {1, 1.2}}),
                             VirtualSite::average(8, {{2, 0.7}, {3, 0.3}}),
                             VirtualSite::average(9, {{2, -0.3}, {3, 1.3}}),
                             VirtualSite::average(10, {{4, 0.5}, {5, 0.3}, {6, 0.2}}),
                             VirtualSite::average(11, {{9, 0.5}, {3, 0.5}})};
constexpr int kAtoms = 13;
const std::vector<std::array<int, 2>> kBonds = {{0, 1}, {2, 3},  {4, 5},   {5, 6},
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
  Vectors forces(const Vectors& at) const { return -spring * at * (inv_mass.array() > 0).cast<double>().matrix().asDiagonal(); }
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
    for (int a = 0; a < sys.atoms(); ++a) s.f.col(a) = sys.mass[a] > 0 ? Vec3(-k * s.x.col(a)) : Vec3(Vec3::Zero());
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
INSTANTIATE_TEST_SUITE_P(
    By, LinkedBodies,
    ::testing::Values(Named{"newton", default_options("newton")}, Named{"mshake", default_options("mshake")},
                      Named{"rattle", default_options("rattle")}, Named{"shake", default_options("shake")},
                      Named{"feedforward", default_options("feedforward"), 1e-5},
                      Named{"baumgarte", default_options("baumgarte"), 1e-5},
                      Named{"centred", Baumgarte::Options{.damping = "centred"}, 1e-3},
                      Named{"swept", Baumgarte::Options{.sweeps = 100}, 1e-5},
                      Named{"lincs", Lincs::Options{.order = 60, .iterations = 4}, 1e-5},
                      Named{"settle", default_options("settle")}),
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
  const State newton = after(default_options("newton"), 1, 0.01, 2), by = after(GetParam().options, 1, 0.01, 2);
  EXPECT_LT(off(by.x, newton.x), GetParam().spread);
  EXPECT_LT(bond_errors(Linked().system, by.x).max, GetParam().spread);
}

}  // namespace
}  // namespace taut::linked_bodies_tests
