#include "constraints/methods/shake.hpp"

namespace taut {

Shake::Shake(const System& sys, const Options& options, double)
    : options_(options), positions_(sys, options), g_(Eigen::VectorXd::Zero(sys.all_bonds())), lambda_(g_) {}

SolveStats Shake::project_positions(const System& sys, double h, State& s) {
  const SolveStats stats = positions_.run(sys, h, s, g_);  // warm start from the previous step's g
  lambda_ = g_ / (h * h);
  return stats;
}

}  // namespace taut
