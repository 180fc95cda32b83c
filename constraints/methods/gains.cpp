#include "constraints/methods/gains.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"

namespace taut {
namespace {

constexpr double kCap = 0.95;  // of the stability limit, for gains that come from outside the step

DimensionlessGains named(const GainChoice& choice, Damping damping, double mu, double h) {
  const std::string& name = choice.name;
  if ((name == "rattle" || name == "swept") && !(choice.reduction > 0))
    throw InputError(
        fmt::format("method.gains = \"{}\": expected method.reduction above 0, what is left of an error "
                    "after a step (taut calibrate finds RATTLE's; with nothing left it is \"dead-beat\")",
                    name));
  if (name == "reversible")
    return damping == Damping::kDiscrete ? DimensionlessGains{0.3, std::sqrt(2.5)}
                                         : DimensionlessGains{0.1, std::numbers::sqrt2};
  if (name == "dead-beat" || name == "hoomd") return gains_for_root(0, damping);
  if (name == "rattle") return gains_for_decay(choice.reduction, damping);
  if (name == "swept") return gains_for_sweeps(choice.reduction, damping);
  if (name == "critical")
    return damping == Damping::kLagged ? DimensionlessGains{0.5, 0.5} : DimensionlessGains{1, 1};
  if (name == "physical") {
    double bh = std::sqrt(choice.stiffness / mu) * h;
    // lagged: βh < 2√(1 − αh) with αh = βh gives βh < 2(√2 − 1)
    bh = std::min(bh, kCap * (damping == Damping::kLagged ? 2 * (std::numbers::sqrt2 - 1) : 2));
    return {bh, bh};
  }
  if (name == "box2d") return {std::numbers::pi, std::numbers::pi / 2};
  // "numbers"
  if (!choice.alpha_per_ps || !choice.beta_per_ps)
    throw InputError("method.gains = \"numbers\": expected alpha_per_ps and beta_per_ps");
  return {0, 0};
}

void check_gains(const Gains& g, Damping damping, double h) {
  const double limit = stability_limit(g.alpha * h, damping);
  if (!(g.alpha >= 0))
    throw InputError(fmt::format("method.alpha_per_ps: {} is negative, it would feed errors", g.alpha));
  if (limit == 0)
    throw InputError(
        fmt::format("method: αh = {:.4g} is unstable with {} damping, which bears less than 1; take "
                    "damping = \"discrete\", a smaller α or a shorter step",
                    g.alpha * h, name_of(damping)));
  if (!(g.beta >= 0 && g.beta * h < limit))
    throw InputError(
        fmt::format("method: βh = {:.4g} at αh = {:.4g} is unstable with {} damping, which bears 0 to "
                    "{:.4g}; take a smaller β or a shorter step",
                    g.beta * h, g.alpha * h, name_of(damping), limit));
}

}  // namespace

std::vector<std::string_view> gain_names() {
  return {"reversible", "dead-beat", "rattle", "swept", "critical", "physical", "hoomd", "box2d", "numbers"};
}

std::vector<Gains> choose_gains(const GainChoice& choice, Damping damping, const System& sys, double h) {
  expect_name("method.gains", choice.name, gain_names());
  std::vector<Gains> gains;
  for (const RigidBond& bond : sys.bonds) {
    const auto [ah, bh] = named(choice, damping, 1 / sys.reduced_inv_mass(bond), h);
    gains.push_back({choice.alpha_per_ps.value_or(ah / h), choice.beta_per_ps.value_or(bh / h)});
    check_gains(gains.back(), damping, h);
  }
  return gains;
}

std::vector<Law> laws_of(const std::vector<Gains>& gains, Damping damping, std::string_view name, double h) {
  std::vector<Law> laws;
  for (const auto& [alpha, beta] : gains) {
    laws.emplace_back(alpha * h, beta * h, h, damping);
    if (name == "hoomd") laws.back().drive = {.square_a = 0.5 * std::pow(h, 4)};
  }
  return laws;
}

}  // namespace taut
