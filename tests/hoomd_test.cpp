// HOOMD-blue's distance constraints (md.constrain.Distance) beside Baumgarte's law.

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/projection.hpp"
#include "free_system.hpp"

namespace taut::hoomd_tests {
namespace {

constexpr double kStep = 0.01;

// As its documentation and its source (Yoneya 2001, doi:10.1006/jcph.2001.6718) have it. Forces are evaluated
// between the kicks, with v_half. q = r + h v_half is where a bond would be a step on without forces; of
// |q + h²(a + M⁻¹Jᵀλ)_ij|² = d² what is quadratic in forces is left out:
//     q·(M⁻¹Jᵀλ)_ij = −(|q|² − d²)/2h² − q·a_ij,     an unsymmetric matrix, solved densely here.
class HoomdDistance : public ConstraintMethod {
 public:
  SolveStats add_forces(const System& sys, const Push&, State& s) override {
    constexpr double h = kStep;
    const int m = sys.bond_count();
    Vectors r(3, m), q(3, m), y_ij(3, m), y(3, sys.atoms());
    differences(sys, s.x, r);
    differences(sys, s.x + h * s.v, q);
    differences(sys, s.f * sys.inv_mass.asDiagonal(), y_ij);
    Eigen::MatrixXd matrix(m, m);
    Eigen::VectorXd wanted(m);
    for (int k = 0; k < m; ++k)
      wanted[k] = -sigma(q.col(k), sys.bonds[k].length) / (h * h) - q.col(k).dot(y_ij.col(k));
    for (int l = 0; l < m; ++l) {
      y.setZero();
      add_constraint_acceleration(sys, r, Eigen::VectorXd::Unit(m, l), y);
      differences(sys, y, y_ij);
      matrix.col(l) = q.cwiseProduct(y_ij).colwise().sum();
    }
    lambda_ = matrix.partialPivLu().solve(wanted);
    add_constraint_force(sys, r, lambda_, s.f);
    return {1, 0, 0};
  }
  const Eigen::VectorXd& lambda() const override { return lambda_; }

 private:
  Eigen::VectorXd lambda_;
};

// Every atom on a spring to the origin.
struct Springs : ForceLaw {
  void evaluate(const System&, State& s) override { s.f = -3 * s.x; }
};

// Its condition leaves σ₊ = ½h⁴|a|², a of all forces: the law at dead-beat with that drive.
TEST(Hoomd, IsTheLawAtDeadBeatWithADrive) {
  auto [sys, hoomds] = tests::free_chain(10, 1);
  Springs forces;
  HoomdDistance hoomd;
  Baumgarte ours(sys, {.gains = "hoomd", .tolerance = 1e-15}, kStep),
      undriven(sys, Feedforward::Options{.tolerance = 1e-15}, kStep);
  initialize({sys, forces, hoomd}, kStep, hoomds);
  State driven = hoomds, at_length = hoomds;
  for (int n = 0; n < 200; ++n) {
    ASSERT_TRUE(step({sys, forces, hoomd}, kStep, hoomds).converged());
    ASSERT_TRUE(step({sys, forces, ours}, kStep, driven).converged());
    ASSERT_TRUE(step({sys, forces, undriven}, kStep, at_length).converged());
    ASSERT_LT((driven.x - hoomds.x).cwiseAbs().maxCoeff(), 1e-10) << n;  // roundings of 200 steps add up
    ASSERT_LT((driven.v - hoomds.v).cwiseAbs().maxCoeff(), 1e-8) << n;
  }
  EXPECT_GT((at_length.x - hoomds.x).cwiseAbs().maxCoeff(), 1e-6);
}

// Where no other forces act, it is the Newton iteration of feedforward from λ = 0.
TEST(Hoomd, IsFeedforwardWithoutAPastInFreeFlight) {
  auto [sys, hoomds] = tests::free_chain(10, 1);
  tests::NoForce forces;
  HoomdDistance hoomd;
  initialize({sys, forces, hoomd}, kStep, hoomds);
  State ours = hoomds;
  for (int n = 0; n < 200; ++n) {
    ASSERT_TRUE(step({sys, forces, hoomd}, kStep, hoomds).converged());
    Baumgarte forgetful(sys, Feedforward::Options{.tolerance = 0.1}, kStep);
    ASSERT_EQ(step({sys, forces, forgetful}, kStep, ours).iterations, 1);
    ASSERT_LT((ours.x - hoomds.x).cwiseAbs().maxCoeff(), 1e-12) << n;
  }
}

}  // namespace
}  // namespace taut::hoomd_tests
