#pragma once

#include <utility>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

// The sums over pairs as they are written down: every pair of atoms, one after the other.

namespace taut::tests {

struct PairSums {
  double energy = 0;       // [kJ/mol]
  Eigen::Matrix3d virial;  // Σ r⊗f [kJ/mol]
  Vectors f;               // [kJ/mol/nm]
  Eigen::RowVectorXd
      clear;  // 0 of atoms of a pair so near the cutoff that one precision may count it, another not; else 1

  explicit PairSums(Eigen::Index atoms = 0)
      : virial(Eigen::Matrix3d::Zero()), f(Vectors::Zero(3, atoms)), clear(Eigen::RowVectorXd::Ones(atoms)) {}

  // E and −r dE/dr of a pair that is d apart.
  void add(int i, int j, const Vec3& d, std::pair<double, double> pair) {
    energy += pair.first;
    const Vec3 push = pair.second / d.squaredNorm() * d;
    virial += d * push.transpose();
    f.col(i) += push;
    f.col(j) -= push;
  }
};

// All but the exceptions, at their nearest images within the cutoff; without a cutoff there are no images.
PairSums plain_pairs(const Nonbonded& nb, const Box& box, const Vectors& x);

// And exceptions by their own numbers: plain 1/r, no cutoff, no images.
PairSums plain_nonbonded(const Nonbonded& nb, const Box& box, const Vectors& x);

// 4ε((σ/r)¹² − (σ/r)⁶) + ε up to its minimum.
PairSums plain_wca(const Wca& wca, const Box& box, const Vectors& x);

// By tables, at their nearest images, each to its own end.
PairSums plain_pairs(const TabulatedPairs& pairs, const Box& box, const Vectors& x);

}  // namespace taut::tests
