#include "simulation/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "md/units.hpp"
#include "simulation/simulation.hpp"

namespace taut {
namespace {

using Doubt = std::optional<std::string>;

constexpr double kStretched = 0.05;  // of a bond
constexpr double kErrors = 5;
constexpr double kWarm = 0.25;     // of kT a nanosecond and degree of freedom, by constraints alone
constexpr double kOff = 0.01;      // of the temperature, where a thermostat bears the drift
constexpr double kRise = 0.1;      // of kT a degree of freedom, from the first row to the last
constexpr double kOffBath = 0.05;  // of the bath's temperature
constexpr double kSettled = 20;    // relaxation times of the bath until a temperature is judged
constexpr int kFewest = 10;        // degrees of freedom of what has a temperature without a bath
constexpr double kWarmer = 1.25;   // than the first row, without a bath
constexpr double kColder = 1.0 / 3;
constexpr double kWorkedOn = 100;  // in place of both where forces from outside do work

// What an energy a degree of freedom is judged by: kT, or, of what is at rest, the least that is no rounding.
struct Energy {
  double kT, least;

  explicit Energy(const Summary& s)
      : kT(kBoltzmann * s.temperature), least(std::max(kT, s.start_and_end.rounding)) {}
  std::string in_words(double energy) const {
    return kT == least ? fmt::format("{:.2g} kT", energy / kT) : fmt::format("{:.2g} kJ/mol", energy);
  }
};

// Five standard deviations of a kinetic energy, as a share of it.
double scatter(double dof) {
  return 5 * std::sqrt(2.0 / std::max(1.0, dof));
}

Doubt of_bonds(const Summary& s) {
  if (s.converged == false)
    return fmt::format("bonds are off by up to {:.1e}, more than the method promises; take a shorter step",
                       s.max_rel_bond_error);
  if (s.max_rel_bond_error > kStretched)
    return fmt::format(
        "bonds are off by up to {:.2g} %; take method newton (rattle where bonds are one-sided), or a "
        "shorter step",
        100 * s.max_rel_bond_error);
  return {};
}

bool much(const Summary& s, double off_by_k) {
  return std::abs(off_by_k) >= kOff * s.temperature;
}

std::string borne(double off_by_k) {
  return fmt::format(", which the thermostat leaves {:.2g} K too {}", std::abs(off_by_k),
                     off_by_k > 0 ? "warm" : "cold");
}

// By the line through all rows, where there are enough of them to tell a trend from chance.
Doubt of_drift(const Summary& s, const Energy& unit) {
  const Estimate& bonds = s.constraint_drift;
  if (s.drift.error == 0 && bonds.error == 0) return {};
  if (s.off_by_k && !much(s, *s.off_by_k)) return {};
  const std::string thermostat = s.off_by_k ? borne(*s.off_by_k) : "";
  if (std::abs(bonds.value) > kWarm * unit.least && std::abs(bonds.value) > kErrors * bonds.error &&
      !(std::abs(bonds.value) <= 0.5 * std::abs(s.drift.value)))  // under a barostat: theirs alone is known
    return fmt::format("the constraints {} by {:.2g} kJ/mol a nanosecond and degree of freedom{}; {}",
                       bonds.value > 0 ? "heat" : "cool", std::abs(bonds.value), thermostat,
                       s.converged
                           ? "take a shorter step"
                           : "feedforward at the same price does not (where bonds are one-sided: rattle)");
  if (std::abs(s.drift.value) > unit.least && std::abs(s.drift.value) > kErrors * s.drift.error)
    return fmt::format("the energy drifts by {} a nanosecond and degree of freedom{}; {}",
                       unit.in_words(s.drift.value), thermostat,
                       s.converged == true
                           ? "take a shorter step, or let pair forces end smoothly (forcefield.switch_nm)"
                           : "take method newton (rattle where bonds are one-sided), or a shorter step");
  return {};
}

// By the last row and the first, where the rows between scatter too much for a line, or are too few.
Doubt of_rise(const Summary& s, const Energy& unit) {
  const StartAndEnd& ends = s.start_and_end;
  const double drift = 1000 * ends.rise / ends.time;  // kJ/mol/ns/dof
  if (!(std::abs(ends.rise) > kRise * unit.least * (1 + scatter(ends.dof)) && std::abs(drift) > unit.least))
    return {};
  if (ends.loses_energy && ends.rise < 0) return {};
  std::string thermostat;
  if (s.off_by_k) {
    const double off = *s.off_by_k / s.drift.value * drift;
    if (!much(s, off)) return {};
    thermostat = borne(off);
  }
  return fmt::format(
      "the energy ends {} a degree of freedom {} its start{}; take a shorter step, or look at the "
      "forces (cutoff_nm, Ewald's α and grid)",
      unit.in_words(std::abs(ends.rise)), ends.rise > 0 ? "above" : "below", thermostat);
}

// Of all atoms, or of all molecules of a kind.
struct Judged {
  std::string whose;  // "", " of 3 molecules of 12 atoms"
  double dof, expected;
  Estimate temperature;
};

bool far_from_bath(const StartAndEnd& ends, const Judged& judged) {
  const auto& [mean, error] = judged.temperature;
  return ends.time >= kSettled * ends.relaxation &&
         std::abs(mean - judged.expected) >= std::max(kOffBath * judged.expected, kErrors * error);
}

bool far_from_start(const StartAndEnd& ends, const Judged& judged) {
  if (judged.dof < kFewest) return false;
  const double warmer = (ends.worked_on ? kWorkedOn : kWarmer) + scatter(judged.dof);
  const double colder = (ends.worked_on ? 1 / kWorkedOn : kColder) / (1 + scatter(judged.dof));
  const double mean = judged.temperature.value;
  return mean >= warmer * judged.expected || mean <= colder * judged.expected;
}

bool known(const Judged& judged) {
  return judged.temperature.value > 0 && judged.expected > 0;
}

Doubt of_temperature(const StartAndEnd& ends, const Judged& judged, const std::string& advice) {
  if (!known(judged)) return {};
  const double mean = judged.temperature.value;
  if (ends.relaxation > 0) {
    if (!far_from_bath(ends, judged)) return {};
    return fmt::format(
        "the thermostat is set to {:.4g} K, and the mean temperature{} over the later half is {:.4g} K; {}{}",
        judged.expected, judged.whose, mean, advice,
        ends.worked_on && mean > judged.expected
            ? ", or pull more slowly: what pulls does work, and a motion of all atoms counts as heat"
            : "");
  }
  if (!far_from_start(ends, judged)) return {};
  return fmt::format(
      "without a thermostat the temperature{} went from {:.4g} to {:.4g} K; relax the start (run.minimise), "
      "or "
      "look at the forces (pulls, cutoff_nm, Ewald's α and grid)",
      judged.whose, judged.expected, mean);
}

Doubt of_all(const StartAndEnd& ends) {
  return of_temperature(ends, {"", static_cast<double>(ends.dof), ends.expected, ends.temperature},
                        "take a shorter step, or a stronger thermostat");
}

// What is shared over all degrees of freedom is little where few molecules take it up: of the kind that is farthest
// off. Without a bath one that is far from all as well as from its own start; kinds may start apart.
Doubt of_kinds(const StartAndEnd& ends) {
  Doubt worst;
  double farthest = 0;
  for (const auto& [name, dof, first, temperature] : ends.kinds) {
    const bool bath = ends.relaxation > 0;
    const Judged kind{" of " + name, dof, bath ? ends.expected : first, temperature};
    if (!bath && !far_from_start(ends, {"", dof, ends.temperature.value, temperature})) continue;
    Doubt doubt = of_temperature(ends, kind,
                                 "take method newton (rattle where bonds are one-sided), or a shorter step");
    const double off = std::abs(std::log(temperature.value / kind.expected));
    if (doubt && off > farthest) worst = std::move(doubt), farthest = off;
  }
  return worst;
}

}  // namespace

std::vector<std::string> doubts(const Summary& s) {
  std::vector<std::string> all;
  const auto add = [&](Doubt doubt) {
    if (!doubt) return false;
    all.push_back(std::move(*doubt));
    return true;
  };
  add(of_bonds(s));
  const Energy unit(s);
  if (!add(of_drift(s, unit))) add(of_rise(s, unit));
  if (!add(of_all(s.start_and_end))) add(of_kinds(s.start_and_end));
  return all;
}

}  // namespace taut
