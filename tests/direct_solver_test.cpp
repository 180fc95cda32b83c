#include "constraints/direct_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "constraints/bond_algebra.hpp"
#include "free_system.hpp"

namespace taut::direct_solver_tests {
namespace {

// J as a dense m × 3n matrix, straight from its definition.
Eigen::MatrixXd dense_jacobian(const System& sys, const Vectors& r) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sys.bond_count(), 3 * sys.atoms());
  for (int k = 0; k < sys.bond_count(); ++k) {
    J.block<1, 3>(k, 3 * sys.bonds[k].i) = -r.col(k).transpose();
    J.block<1, 3>(k, 3 * sys.bonds[k].j) = r.col(k).transpose();
  }
  return J;
}

// J(r_new) M⁻¹ J(r)ᵀ
Eigen::MatrixXd dense_A(const System& sys, const Vectors& r_new, const Vectors& r) {
  const Eigen::VectorXd inv_mass = sys.inv_mass.transpose().replicate(3, 1).reshaped();
  return dense_jacobian(sys, r_new) * inv_mass.asDiagonal() * dense_jacobian(sys, r).transpose();
}

struct Shape {
  const char* name;
  int atoms;
  std::vector<std::array<int, 2>> bonds;
  int fill;
};

const Shape kShapes[] = {
    {"chain", 6, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}}, 0},
    {"ends turned round", 5, {{1, 0}, {1, 2}, {3, 2}, {3, 4}}, 0},
    {"star", 5, {{0, 1}, {2, 0}, {0, 3}, {4, 0}}, 0},
    {"tree", 7, {{0, 1}, {0, 2}, {1, 3}, {1, 4}, {2, 5}, {2, 6}}, 0},
    {"ring", 6, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}}, 3},
    {"triangle and chain apart", 6, {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}}, 0},
};

System system_of(const Shape& shape, const Eigen::VectorXd& mass) {
  std::vector<RigidBond> bonds;
  for (const auto& [i, j] : shape.bonds) bonds.push_back({i, j, 1});
  return make_system(mass, bonds);
}

TEST(DirectSolver, SolvesWithAOfTheDefinitionForEveryShape) {
  for (const Shape& shape : kShapes) {
    SCOPED_TRACE(shape.name);
    Random random(7);
    Eigen::VectorXd mass(shape.atoms);
    for (auto& m : mass) m = 0.5 + random.uniform();
    mass[1] = 0;  // an anchor
    const System sys = system_of(shape, mass);
    Vectors x(3, shape.atoms);
    for (int a = 0; a < shape.atoms; ++a) x.col(a) = random.normal_vector();
    Vectors r(3, sys.bond_count());
    differences(sys, x, r);

    DirectSolver solver(sys);
    solver.factor(r);
    EXPECT_FALSE(solver.singular());
    Eigen::VectorXd b(sys.bond_count());
    for (auto& value : b) value = random.normal();
    Eigen::VectorXd got = b;
    solver.solve(got);
    const Eigen::VectorXd want = dense_A(sys, r, r).ldlt().solve(b);
    EXPECT_LT((got - want).norm(), 1e-12 * want.norm());

    // the same bonds turned by up to half a radian
    Vectors r_new = r;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const Vec3 axis = random.unit_vector();
      r_new.col(k) = Eigen::AngleAxisd(random.uniform() - 0.5, axis) * r.col(k);
    }
    solver.factor(r_new, r);
    EXPECT_FALSE(solver.singular());
    got = b;
    solver.solve(got);
    const Eigen::VectorXd want_turned = dense_A(sys, r_new, r).partialPivLu().solve(b);
    EXPECT_LT((got - want_turned).norm(), 1e-11 * want_turned.norm());
  }
}

TEST(Elimination, ChainsAndTreesHaveNoFillAndRingsLittle) {
  for (const Shape& shape : kShapes) {
    SCOPED_TRACE(shape.name);
    const System sys = system_of(shape, Eigen::VectorXd::Ones(shape.atoms));
    const Couplings couplings(sys);
    const Elimination plan(couplings);
    EXPECT_EQ(plan.entries() - static_cast<int>(couplings.pairs.size()), shape.fill);
    EXPECT_EQ(plan.clusters(), std::string_view(shape.name).ends_with("apart") ? 2 : 1);
  }
}

TEST(Elimination, RingsGoByEverySecondBond) {
  const Elimination plan(Couplings(system_of(kShapes[4], Eigen::VectorXd::Ones(6))));
  EXPECT_EQ(plan.order, (std::vector<int>{0, 2, 4, 1, 3, 5}));
}

TEST(DirectSolver, AgreesWithEigensOnARandomGraph) {
  constexpr int n = 40;
  Random random(3);
  Shape shape{"random", n, {}, 0};
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      if (random.uniform() < 0.08)
        shape.bonds.push_back(random.uniform() < 0.5 ? IndexPair{a, b} : IndexPair{b, a});
  const System sys = system_of(shape, Eigen::VectorXd::Ones(n));
  const Couplings couplings(sys);
  EXPECT_GT(Elimination(couplings).entries(), 1.2 * static_cast<double>(couplings.pairs.size()));
  Vectors r(3, sys.bond_count());
  Eigen::VectorXd b(sys.bond_count());
  for (auto& value : r.reshaped()) value = random.normal();
  for (auto& value : b) value = random.normal();

  DirectSolver solver(sys);
  solver.factor(r);
  Eigen::VectorXd got = b;
  solver.solve(got);
  EXPECT_FALSE(solver.singular());
  const Eigen::VectorXd want = dense_A(sys, r, r).ldlt().solve(b);
  EXPECT_LT((got - want).norm(), 1e-11 * want.norm());
}

// A square closed in a plane with both diagonals: six bonds, but a plane quadrilateral bears five.
TEST(DirectSolver, FindsABondThatFollowsFromTheOthers) {
  const System sys = make_system(
      Eigen::VectorXd::Ones(4),
      {{0, 1, 1.0}, {1, 2, 1.0}, {2, 3, 1.0}, {3, 0, 1.0}, {0, 2, std::sqrt(2.0)}, {1, 3, std::sqrt(2.0)}});
  Vectors x(3, 4);
  x << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  Vectors r(3, 6);
  differences(sys, x, r);
  DirectSolver solver(sys);
  solver.factor(r);
  EXPECT_EQ(solver.dependent_bonds().size(), 1u);

  x(2, 2) = 0.4;  // a corner lifted out of the plane: all six count
  differences(sys, x, r);
  solver.factor(r);
  EXPECT_FALSE(solver.singular());
}

TEST(BondAlgebra, ConstraintForceIsJTransposedLambda) {
  const auto start = tests::free_chain(5, 11);
  const System& sys = start.system;
  Vectors r(3, 4);
  differences(sys, start.state.x, r);
  const Eigen::VectorXd lambda = Eigen::Vector4d(1, -2, 3, 0.5);
  Vectors f = Vectors::Zero(3, 5);
  add_constraint_force(sys, r, lambda, f);
  const Eigen::VectorXd want = dense_jacobian(sys, r).transpose() * lambda;
  EXPECT_LT((f.reshaped() - want).norm(), 1e-15);
  EXPECT_LT(f.rowwise().sum().norm(), 1e-14);  // no net force
}

}  // namespace
}  // namespace taut::direct_solver_tests
