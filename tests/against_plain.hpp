#pragma once

#include <gtest/gtest.h>

#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "every_machine.hpp"
#include "free_system.hpp"

namespace taut {

using tests::on_every_machine;
using tests::on_one_to_three_threads;
using tests::Start;

// Several starts as one system, the k-th moved aside by k·spacing, and its atoms renumbered by `order` of all
// atoms.
inline Start together(const std::vector<Start>& parts, const std::vector<int>& order = {},
                      double spacing = 3) {
  int atoms = 0;
  for (const Start& part : parts) atoms += part.system.atoms();
  std::vector<int> place(atoms);
  std::iota(place.begin(), place.end(), 0);
  if (!order.empty()) place = order;
  Start all;
  all.state.x.resize(3, atoms);
  all.state.v.resize(3, atoms);
  all.state.f = Vectors::Zero(3, atoms);
  Eigen::VectorXd mass(atoms);
  std::vector<RigidBond> bonds;
  int first = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& [sys, s] = parts[p];
    for (int a = 0; a < sys.atoms(); ++a) {
      all.state.x.col(place[first + a]) = s.x.col(a) + Vec3(spacing * static_cast<double>(p), 0, 0);
      all.state.v.col(place[first + a]) = s.v.col(a);
      mass[place[first + a]] = sys.mass[a];
    }
    for (const auto& [i, j, d] : sys.bonds) bonds.push_back({place[first + i], place[first + j], d});
    first += sys.atoms();
  }
  all.system = make_system(std::move(mass), std::move(bonds));
  return all;
}

inline std::vector<Start> chains(int count, int beads, std::uint64_t seed) {
  std::vector<Start> chains;
  for (int c = 0; c < count; ++c) chains.push_back(tests::free_chain(beads, seed + c));
  return chains;
}

// NaN where there is one.
inline double largest(const auto& differences) {
  return differences.cwiseAbs().template maxCoeff<Eigen::PropagateNaN>();
}

// Runs a method beside a witness from the same start.
inline void compare_here(const Start& start, ConstraintMethod& fast, ConstraintMethod& plain,
                         double tolerance) {
  constexpr double h = 0.001;
  const System& sys = start.system;
  State a = start.state, b = start.state;
  tests::UniformForce forces{Vec3(1, 2, -9.81)};
  initialize({sys, forces, fast}, h, a);
  initialize({sys, forces, plain}, h, b);
  for (int n = 0; n < 12; ++n) {
    const SolveStats got = step({sys, forces, fast}, h, a), want = step({sys, forces, plain}, h, b);
    ASSERT_EQ(got.failure, Failure::kNone);
    ASSERT_EQ(want.failure, Failure::kNone);
    EXPECT_NEAR(got.max_residual, want.max_residual, tolerance + 1e-6 * want.max_residual);
    if (want.max_residual > 1e3 * tolerance) {
      EXPECT_EQ(got.worst_bond, want.worst_bond);
    }
    EXPECT_LE(std::abs(got.iterations - want.iterations), 1 + want.iterations / 15);  // rounding ends sweeps
  }
  const double lambda = 1 + largest(plain.lambda());
  EXPECT_LT(largest(a.x - b.x), 10 * tolerance);
  EXPECT_LT(largest(a.v - b.v), 10 * tolerance / h);
  EXPECT_LT(largest(a.f - b.f), 1e5 * tolerance * lambda);
  EXPECT_LT(largest(fast.lambda() - plain.lambda()), 1e5 * tolerance * lambda);
}

// ... both forms of a method.
inline void compare_here(const Start& start, const MethodOptions& options, double tolerance) {
  constexpr double h = 0.001;
  const auto fast = make_method(start.system, options, h), plain = make_plain(start.system, options, h);
  compare_here(start, *fast, *plain, tolerance);
  EXPECT_EQ(fast->setting(), plain->setting());
  EXPECT_EQ(fast->promised_error(), plain->promised_error());
}

// What the method says of a start and a step from it that it cannot hold. Some fail in the first already.
inline SolveStats start_and_step(const System& sys, const MethodOptions& options, double h, State s) {
  tests::NoForce forces;
  const auto method = make_method(sys, options, h);
  Projector projector(sys);
  projector.positions(sys, s.x);
  projector.velocities(sys, s.x, s.v);
  forces.evaluate(sys, s);
  SolveStats stats = method->add_forces(sys, Push::at_start(h), s);
  return stats += step({sys, forces, *method}, h, s);
}

inline void compare(const Start& start, const MethodOptions& options, double tolerance) {
  on_every_machine([&] { compare_here(start, options, tolerance); });
}

}  // namespace taut
