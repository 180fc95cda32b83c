// The active set of one-sided bonds, cluster by cluster.

#include "constraints/active_set.hpp"

#include <gtest/gtest.h>

#include "constraints/bond_algebra.hpp"
#include "free_system.hpp"

namespace taut::active_set_tests {
namespace {

// Chains of five beads; in each a rope, and struts between beads that are not neighbours, each as long as it is, so that
// all touch. The first beads are tied to one anchor, which couples nothing, and those of the first two chains to each
// other.
struct Chains {
  System system;
  Vectors x, v;

  explicit Chains(int count) {
    constexpr int kBeads = 5;
    Eigen::VectorXd mass = Eigen::VectorXd::Ones(count * kBeads + 1);
    const int anchor = count * kBeads;
    mass[anchor] = 0;
    x = v = Vectors::Zero(3, anchor + 1);
    std::vector<RigidBond> bonds;
    std::vector<OneSidedBond> one_sided;
    const auto touch = [&](int i, int j, Side side) {
      one_sided.push_back({{i, j, (x.col(j) - x.col(i)).norm()}, side});
    };
    for (int c = 0; c < count; ++c) {
      const int first = c * kBeads;
      const tests::Start chain = tests::free_chain(kBeads, 50 + c);
      x.middleCols(first, kBeads) = chain.state.x.colwise() + Vec3(1 + c % 7, c % 3, 0);
      v.middleCols(first, kBeads) = chain.state.v;
      for (const auto& [i, j, d] : chain.system.bonds) bonds.push_back({first + i, first + j, d});
      touch(first, first + 2, Side::kAtLeast);
      touch(first + 1, first + 4, Side::kAtLeast);
      touch(first, first + 4, Side::kAtMost);
      touch(anchor, first, Side::kAtLeast);
    }
    touch(0, kBeads, Side::kAtMost);
    system = make_system(mass, bonds, {}, one_sided);
  }
};

// What one active set of all clusters finds, and one for two that a rope couples.
TEST(ActiveSet, IsThatOfEachCluster) {
  constexpr int kChains = 40;
  const Chains chains(kChains);
  const System& sys = chains.system;
  Vectors r(3, sys.all_bonds());
  differences(sys, chains.x, r);
  Eigen::VectorXd b(sys.all_bonds()), together = Eigen::VectorXd::Zero(sys.all_bonds()), apart = together;
  for (int k = 0; k < sys.all_bonds(); ++k)
    b[k] = -r.col(k).dot(chains.v.col(sys.bond(k).j) - chains.v.col(sys.bond(k).i));
  ActiveSet sets(sys);
  EXPECT_EQ(sets.clusters(), kChains - 1);
  ASSERT_EQ(sets.solve(sys, r, b, apart), Failure::kNone);
  ActiveSetOfCluster set(sys);
  ASSERT_EQ(set.solve(sys, r, b, together), Failure::kNone);
  EXPECT_GT((apart.tail(sys.all_bonds() - sys.bond_count()).array() != 0).count(), kChains);
  Vectors difference = Vectors::Zero(3, sys.atoms());
  add_constraint_acceleration(sys, r, apart - together, difference);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-8);
}

// Where nothing is one-sided, there is one.
TEST(ActiveSet, LeavesOrdinaryClustersTogether) {
  System sys = Chains(10).system;
  const auto of_first = sys.one_sided.front();
  sys.one_sided = {of_first};
  EXPECT_EQ(ActiveSet(sys).clusters(), 2);
}

}  // namespace
}  // namespace taut::active_set_tests
