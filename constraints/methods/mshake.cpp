#include "constraints/methods/mshake.hpp"

namespace taut {

bool MShake::solve(Eigen::VectorXd& b, SolveStats& stats) {
  return solve_exactly(b, stats);
}

}  // namespace taut
