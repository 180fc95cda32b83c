#include "constraints/gains.hpp"

#include <fmt/format.h>

#include <cmath>

#include "md/errors.hpp"

namespace taut {

Gains choose_gains(const std::string& name, std::optional<double> alpha, std::optional<double> beta,
                   double h) {
  Gains g;
  if (name == "critical") {
    g = {1 / h, 1 / h};
  } else if (name == "dead-beat") {
    g = gains_for_root(0, h);
  } else if (name == "reversible") {
    g = {0.05 / h, std::sqrt(2.0) / h};
  } else if (name == "numbers") {
    if (!alpha || !beta)
      throw InputError("method.gains = \"numbers\": expected alpha_per_ps and beta_per_ps");
  } else {
    throw InputError(
        fmt::format("method.gains: \"{}\" is not one of critical, dead-beat, reversible, numbers", name));
  }
  g.alpha = alpha.value_or(g.alpha);
  g.beta = beta.value_or(g.beta);
  if (!(g.alpha >= 0))
    throw InputError(fmt::format("method.alpha_per_ps: {} is negative, it would feed errors", g.alpha));
  if (!(g.beta * h < 2))
    throw InputError(fmt::format("method.beta_per_ps: {} times the step of {} ps is {:.3g}, stable below 2",
                                 g.beta, h, g.beta * h));
  return g;
}

// Trace 2r and determinant r² of the step, solved for αh and βh.
Gains gains_for_root(double r, double h) {
  const double q = 1 + r * r;
  return {(1 - r * r) / q / h, std::sqrt(2 / q) * (1 - r) / h};
}

}  // namespace taut
