#include "md/run.hpp"

#include <fmt/format.h>

#include <string_view>

namespace taut {
namespace {

std::string_view advice(const SolveStats& stats) {
  const std::string_view failure = stats.failure ? stats.failure : "";
  if (failure.find("90°") != failure.npos)
    return "the bond turns too fast for the step: take a shorter one, or a cooler start";
  if (failure.find("singular") != failure.npos)
    return "bonds lie in line or in a plane, so that no force can hold them all: drop one, or bend them";
  if (failure.find("convergence") != failure.npos)
    return "take a shorter step, a looser tolerance, or allow more sweeps";
  return "take a shorter step, or a method that holds bonds more firmly (newton, rattle)";
}

}  // namespace

std::string explain_failure(const System& sys, const State& s, const SolveStats& stats, long step) {
  std::string bond = "no bond to blame";
  if (stats.worst_bond >= 0) {
    const auto& [i, j, d] = sys.bonds[stats.worst_bond];
    bond = fmt::format("bond {} (atoms {}-{}) is {:.6g} nm, held at {:.6g} nm", stats.worst_bond, i, j,
                       (s.x.col(j) - s.x.col(i)).norm(), d);
  }
  Eigen::Index atom = 0;
  const double largest = s.f.cols() > 0 ? std::sqrt(s.f.colwise().squaredNorm().maxCoeff(&atom)) : 0.0;
  return fmt::format(
      "step {} (t = {:.6g} ps): {}\n  {}\n  largest force: {:.4g} kJ/mol/nm on atom {}\n  try: {}", step, s.t,
      stats.failure ? stats.failure : "a bond broke or a number ran away", bond, largest, atom,
      advice(stats));
}

}  // namespace taut
