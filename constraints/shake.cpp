#include "constraints/shake.hpp"

#include <fmt/format.h>

namespace taut {

Shake::Shake(const System& sys, const Options& options, double)
    : options_(checked(options)),
      positions_(sys, {options.tolerance, options.max_sweeps, options.sweeps}),
      g_(Eigen::VectorXd::Zero(sys.bond_count())),
      lambda_(g_) {}

SolveStats Shake::project_positions(const System& sys, double h, State& s) {
  const SolveStats stats = positions_.run(sys, h, s, g_);  // warm: from the g of the step before
  lambda_ = g_ / (h * h);
  return stats;
}

std::string Shake::setting() const {
  if (options_.sweeps > 0) return fmt::format("{} sweeps", options_.sweeps);
  return fmt::format("tolerance {:g}", options_.tolerance);
}

}  // namespace taut
