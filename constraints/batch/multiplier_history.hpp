#pragma once

#include <Eigen/Core>

#include "md/constraint_method.hpp"

namespace taut {

// The past a method extrapolates its multipliers from, bond by bond, for a caller whose bonds come and go:
// where each processor holds the bonds near it, multipliers travel with their atoms.
class MultiplierHistory {
 public:
  virtual ~MultiplierHistory() = default;

  virtual int steps_kept() const = 0;   // columns of `past`
  virtual int steps_known() const = 0;  // how many of them count
  // past: m × steps_kept(), newest first.
  virtual void read(Eigen::MatrixXd& past) = 0;
  virtual void write(const Eigen::MatrixXd& past, int known) = 0;

  // The last add_forces once more, from the multipliers it found, under other forces or velocities.
  virtual SolveStats again(const System& sys, const Push& push, State& s) = 0;
};

}  // namespace taut
