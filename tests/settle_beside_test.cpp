// SETTLE for the waters, another method for the rest.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "constraints/batch/batched.hpp"
#include "constraints/methods/settle.hpp"
#include "free_system.hpp"
#include "verifier.hpp"

namespace taut::settle_beside_tests {
namespace {

using tests::NoForce, tests::Start, tests::verify;

// A chain between two waters and one more, so that neither's bonds lie in a row.
Start chain_among_waters() {
  const Start waters = tests::waters(3, 12, 300), chain = tests::free_chain(6, 3, 1, 12);
  const int before = 6, links = 6, n = waters.system.atoms() + links;
  const auto at = [&](int water_atom) { return water_atom < before ? water_atom : water_atom + links; };
  Start both;
  both.state.x = both.state.v = both.state.f = Vectors::Zero(3, n);
  Eigen::VectorXd mass(n);
  std::vector<RigidBond> bonds;
  const auto place = [&](const Start& from, auto where) {
    for (int a = 0; a < from.system.atoms(); ++a) {
      both.state.x.col(where(a)) = from.state.x.col(a);
      both.state.v.col(where(a)) = from.state.v.col(a);
      mass[where(a)] = from.system.mass[a];
    }
    for (const auto& [i, j, d] : from.system.bonds) bonds.push_back({where(i), where(j), d});
  };
  place(waters, at);
  place(chain, [](int a) { return a + 6; });
  std::swap(bonds[1], bonds[10]);
  both.system = make_system(mass, bonds);
  return both;
}

TEST(SettleBeside, HoldsWatersAndLeavesTheRestToAnother) {
  const Start start = chain_among_waters();
  NoForce forces;
  const auto newton =
      verify(start.system, forces, Newton::Options{.tolerance = 1e-13}, 0.002, 200, start.state);
  for (const char* solute : {"newton", "rattle", "mshake"}) {
    const auto both =
        verify(start.system, forces, Settle::Options{.solute = solute}, 0.002, 200, start.state);
    ASSERT_TRUE(both.stats.converged()) << solute;
    EXPECT_LT(both.bond_error, 2e-10) << solute;
    EXPECT_LT((both.end.x - newton.end.x).cwiseAbs().maxCoeff(), 1e-7) << solute;
    EXPECT_LT((both.lambda - newton.lambda).norm(), 1e-4 * newton.lambda.norm()) << solute;
    EXPECT_LT(both.momentum_change, 1e-12) << solute;
  }
  // Those that steer by forces act in their own stage.
  for (const char* solute : {"feedforward", "baumgarte"}) {
    const auto both =
        verify(start.system, forces, Settle::Options{.solute = solute}, 0.001, 200, start.state);
    ASSERT_TRUE(both.stats.converged()) << solute;
    EXPECT_LT(both.bond_error, 1e-6) << solute;
    EXPECT_THAT(make_method(start.system, Settle::Options{.solute = solute}, 0.001)->setting(),
                ::testing::StartsWith(fmt::format("3 waters; 5 bonds of the rest by {} ", solute)));
  }
}

// Counts how often it is asked for its multipliers, which a batched method gathers anew each time.
struct Counting : ConstraintMethod {
  explicit Counting(const System& sys) : multipliers(Eigen::VectorXd::Ones(sys.bond_count())) {}
  const Eigen::VectorXd& lambda() const override {
    ++asked;
    return multipliers;
  }
  Eigen::VectorXd multipliers;
  mutable int asked = 0;
};

TEST(SettleBeside, GathersMultipliersOnceForAllBonds) {
  const System sys = tests::free_chain(6, 1).system;
  const Leftover<Counting> part(sys, {1, 3, 4},
                                [](const System& of_part) { return std::make_unique<Counting>(of_part); });
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(sys.bond_count());
  part.write_lambda(lambda);
  EXPECT_EQ(lambda, (Eigen::VectorXd(5) << 0, 1, 0, 1, 1).finished());
  EXPECT_EQ(part.method().asked, 1);
}

TEST(SettleBeside, IsAskedForAndGoesOnFromACheckpoint) {
  const Start start = chain_among_waters();
  EXPECT_THROW(make_method(start.system, Settle::Options{}, 0.001), InputError);
  NoForce forces;
  const auto make = [&] {
    return make_method(start.system, Settle::Options{.solute = "feedforward"}, 0.001);
  };
  const auto whole = make();
  State s = start.state;
  initialize({start.system, forces, *whole}, 0.001, s);
  const auto steps = [&](ConstraintMethod& method, State& state) {
    for (int n = 0; n < 20; ++n) ASSERT_TRUE(step({start.system, forces, method}, 0.001, state).converged());
  };
  steps(*whole, s);
  const auto again = make();
  State copy = s;
  std::string kept;
  Archive saving = Archive::saving_to(kept);
  whole->serialize(saving);
  Archive loading = Archive::loading_from(kept);
  again->serialize(loading);
  loading.finish();
  steps(*whole, s);
  steps(*again, copy);
  EXPECT_EQ(s.x, copy.x);
  EXPECT_EQ(whole->lambda(), again->lambda());
}

}  // namespace
}  // namespace taut::settle_beside_tests
