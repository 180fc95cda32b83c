#include "constraints/methods/rattle.hpp"

namespace taut {

Rattle::Rattle(const System& sys, const Options& options, double)
    : options_(options),
      positions_(sys, options),
      velocities_(sys, options),
      g_(Eigen::VectorXd::Zero(sys.all_bonds())),
      lambda_(g_) {}

SolveStats Rattle::project_positions(const System& sys, double h, State& s) {
  if (options_.warm_start)
    g_ = 0.5 * h * h * lambda_;
  else
    g_.setZero();
  const SolveStats stats = positions_.run(sys, h, s, g_);
  lambda_ = 2 / (h * h) * g_;
  return stats;
}

SolveStats Rattle::project_velocities(const System& sys, double h, State& s) {
  if (options_.warm_start)
    g_ = 0.5 * h * lambda_;
  else
    g_.setZero();
  const SolveStats stats = velocities_.run(sys, h, s, lambda_, g_);
  lambda_ = 2 / h * g_;
  return stats;
}

std::string Rattle::setting() const {
  return options_.setting() + (options_.warm_start ? "" : ", cold start");
}

}  // namespace taut
