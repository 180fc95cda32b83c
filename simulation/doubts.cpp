#include "simulation/doubts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "md/units.hpp"
#include "simulation/simulation.hpp"

namespace taut {
namespace {

constexpr double kStretched = 0.05;  // of a bond
constexpr double kErrors = 5;
constexpr double kWarm = 0.25;  // of kT a nanosecond and degree of freedom, by constraints alone
constexpr double kOff = 0.01;   // of the temperature, where a thermostat bears the drift

}  // namespace

std::vector<std::string> doubts(const Summary& s) {
  std::vector<std::string> all;
  if (s.converged == false)
    all.push_back(
        fmt::format("bonds are off by up to {:.1e}, more than the method promises; take a shorter step",
                    s.max_rel_bond_error));
  else if (s.max_rel_bond_error > kStretched)
    all.push_back(fmt::format("bonds are off by up to {:.2g} %; take method newton, or a shorter step",
                              100 * s.max_rel_bond_error));
  const Estimate& bonds = s.constraint_drift;
  if (s.drift.error == 0 && bonds.error == 0) return all;
  const double kT = kBoltzmann * s.temperature;
  const double heat = s.drift.value / kT;  // per ns
  std::string thermostat;
  if (s.off_by_k) {
    if (std::abs(*s.off_by_k) < kOff * s.temperature) return all;
    thermostat = fmt::format(", which the thermostat leaves {:.2g} K too {}", std::abs(*s.off_by_k),
                             *s.off_by_k > 0 ? "warm" : "cold");
  }
  if (std::abs(bonds.value) > kWarm * kT && std::abs(bonds.value) > kErrors * bonds.error &&
      !(std::abs(bonds.value) <= 0.5 * std::abs(s.drift.value))) {  // under a barostat: theirs alone is known
    all.push_back(
        fmt::format("the constraints {} by {:.2g} kJ/mol a nanosecond and degree of freedom{}; {}",
                    bonds.value > 0 ? "heat" : "cool", std::abs(bonds.value), thermostat,
                    s.converged ? "take a shorter step" : "feedforward at the same price does not"));
    return all;
  }
  if (std::abs(heat) > 1 && std::abs(s.drift.value) > kErrors * s.drift.error)
    all.push_back(fmt::format(
        "the energy drifts by {:.2g} kT a nanosecond and degree of freedom{}; {}", heat, thermostat,
        s.converged == true ? "take a shorter step, or let pair forces end smoothly (forcefield.switch_nm)"
                            : "take method newton, or a shorter step"));
  return all;
}

}  // namespace taut
