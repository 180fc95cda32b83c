// What holding bonds rigid does to the shapes of chains, and what it does not.

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "ensembles/langevin.hpp"
#include "free_system.hpp"
#include "md/units.hpp"

namespace taut::chain_statistics_tests {
namespace {

constexpr double kStep = 0.05;  // with b = m = kT = 1

// `count` chains, all bent at right angles: no chain's equilibrium.
tests::Start chains(int count, int beads) {
  tests::Start start;
  State& s = start.state;
  s.x.resize(3, count * beads);
  s.v = s.f = Vectors::Zero(3, count * beads);
  std::vector<RigidBond> bonds;
  for (int i = 0; i < count * beads; ++i) {
    const int bead = i % beads;
    s.x.col(i) << (bead + 1) / 2, bead / 2, 0;
    if (bead > 0) bonds.push_back({i - 1, i, 1.0});
  }
  start.system = make_system(Eigen::VectorXd::Ones(count * beads), bonds);
  return start;
}

// Runs at kT = 1, seeing a state every 20 steps after the first 1000.
template <class Method>
void sample(tests::Start start, long steps, auto&& see) {
  const System& sys = start.system;
  tests::NoForce forces;
  Method method(sys, {}, kStep);
  Langevin bath(sys, {.temperature = 1 / kBoltzmann, .friction = 1, .seed = 5}, kStep);
  initialize(bath, {sys, forces, method}, kStep, start.state);
  for (long n = 1; n <= steps; ++n) {
    ASSERT_TRUE(bath.advance({sys, forces, method}, kStep, start.state).converged());
    if (n > 1000 && n % 20 == 0) see(start.state.x);
  }
}

template <class Method>
class ChainsOf : public ::testing::Test {};
using MethodsUnderTest = ::testing::Types<Newton, Baumgarte>;
TYPED_TEST_SUITE(ChainsOf, MethodsUnderTest);

// With c the cosine between its bonds a trimer has det A = 4 − c² and P(c) ∝ √det A: ⟨c²⟩ = 0.32102. Fixman's
// potential ½kT ln det A (1974, doi:10.1073/pnas.71.8.3050) makes c uniform, ⟨c²⟩ = ⅓: as a weight 1/√det A
// on what was sampled without it.
TYPED_TEST(ChainsOf, TrimersBendAsRigidBondsMakeThem) {
  constexpr int kChains = 150;
  double sum = 0, weights = 0, weighted = 0, samples = 0;
  sample<TypeParam>(chains(kChains, 3), 4000, [&](const Vectors& x) {
    for (int a = 0; a < 3 * kChains; a += 3) {
      const Vec3 u = x.col(a + 1) - x.col(a), w = x.col(a + 2) - x.col(a + 1);
      const double c2 = std::pow(u.dot(w), 2), weight = 1 / std::sqrt(4 - c2);
      sum += c2, weighted += weight * c2, weights += weight, ++samples;
    }
  });
  EXPECT_NEAR(sum / samples, 0.32102, 0.006);
  EXPECT_NEAR(weighted / weights, 1.0 / 3, 0.006);
}

// det A holds squares of the cosines between neighbouring bonds only, A being tridiagonal. So P does not
// change when all bonds from the kth on are reversed, every ⟨u_k·u_l⟩ is zero, and ⟨R²⟩ = N b² is exact for
// rigid bonds too, at any masses. What they change is the spread: ⟨c²⟩ of neighbours is below ⅓.
TEST(FreelyJointed, EndsAreAsFarApartAsARandomWalks) {
  constexpr int kChains = 100, kBeads = 5;
  double sum = 0, squares = 0, samples = 0;
  sample<Newton>(chains(kChains, kBeads), 5000, [&](const Vectors& x) {
    for (int a = 0; a < kChains * kBeads; a += kBeads) {
      sum += (x.col(a + kBeads - 1) - x.col(a)).squaredNorm(), ++samples;
      for (int k = a + 1; k < a + kBeads - 1; ++k)
        squares += std::pow((x.col(k) - x.col(k - 1)).dot(x.col(k + 1) - x.col(k)), 2) / (kBeads - 2);
    }
  });
  EXPECT_NEAR(sum / samples, kBeads - 1, 0.1);
  EXPECT_LT(squares / samples, 1.0 / 3 - 0.005);
}

}  // namespace
}  // namespace taut::chain_statistics_tests
