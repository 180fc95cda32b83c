#include "constraints/methods/mshake.hpp"

namespace taut {

bool MShake::solve(Eigen::VectorXd& b, SolveStats& stats) {
  exact_.factor(r_, r_old_);
  if (exact_.singular()) {
    stats.worst_bond = exact_.dependent_bonds().front();
    stats.failure = Failure::kSingularOrTurned;
    return false;
  }
  exact_.solve(b);
  return true;
}

}  // namespace taut
