#pragma once

#include <Eigen/Core>

#include "md/constraint_method.hpp"

namespace taut {

// The multipliers of previous steps from which a method extrapolates, for a caller whose bonds come and go:
// if each processor holds the bonds near it, multipliers migrate with their atoms.
class MultiplierHistory {
 public:
  virtual ~MultiplierHistory() = default;

  virtual int steps_kept() const = 0;   // number of columns of `past`
  virtual int steps_known() const = 0;  // number of columns that are known
  // past: m × steps_kept(), newest first.
  virtual void read(Eigen::MatrixXd& past) = 0;
  virtual void write(const Eigen::MatrixXd& past, int known) = 0;

  // Repeats the last add_forces() with other forces or velocities, starting from the multipliers it found.
  virtual SolveStats again(const System& sys, const Push& push, State& s) = 0;
};

}  // namespace taut
