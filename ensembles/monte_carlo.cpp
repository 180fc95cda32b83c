#include "ensembles/monte_carlo.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "md/step_parts.hpp"

namespace taut {

MonteCarloBarostat::MonteCarloBarostat(const System& sys, const std::vector<int>& molecule,
                                       const PressureCoupling& coupling, RunForces& forces)
    : centres_(sys, molecule), forces_(forces), coupling_(coupling), random_{coupling.seed} {}

double MonteCarloBarostat::energy(const System& sys) {
  return forces_.field.evaluate_energy_alone(sys, trial_);
}

// What is bonded around the box stretches with it: springs may break, leave their tables or reach over half the box.
double MonteCarloBarostat::energy_of_box(const System& sys) {
  try {
    return energy(sys);
  } catch (const SimulationFailure& failure) {
    if (without_energy_++ == 0) why_without_energy_ = failure.what();
    return std::numeric_limits<double>::infinity();
  }
}

double MonteCarloBarostat::move_box(const System& sys, State& s) {
  if (steps_ == 0 || steps_ % coupling_.every != 0) return 0;
  const PartScope here(StepPart::kBarostat);
  trial_ = s;
  const double V = s.box.volume(), before = energy(sys);
  if (largest_ == 0) largest_ = 0.01 * V;
  RandomOfStep random = random_.next(Stream::kMonteCarlo);
  const double to = V + largest_ * (2 * random.uniform() - 1), chance = random.uniform();
  const Vec3 mu = Vec3::Constant(std::cbrt(std::max(to, 0.0) / V));
  trial_.box = s.box.scaled(mu);
  const bool too_narrow = !forces_.field.lack_of_room(trial_.box).empty();
  ++trials_;
  too_narrow_ += too_narrow;
  if (to > 0 && !too_narrow) {
    centres_.scale_positions(mu, trial_.x);
    const double W = energy_of_box(sys) - before + coupling_.pressure * (to - V) -
                     centres_.groups() * coupling_.kT * std::log(to / V);
    if (chance < std::exp(-W / coupling_.kT)) {
      s.x = trial_.x;
      s.box = trial_.box;
      ++taken_;
    }
  }
  if (++tried_ == kTrials) adapt();
  return 0;
}

std::string MonteCarloBarostat::doubt() const {
  if (without_energy_ > 0)
    return fmt::format(
        "the barostat refused {} of {} trial boxes, as in them forces have no value, which keeps volumes "
        "from "
        "there; in the first {}",
        without_energy_, trials_, why_without_energy_);
  if (too_narrow_ == 0) return "";
  return fmt::format(
      "the barostat refused {} of {} trial boxes as too narrow for the cutoff, which keeps the volume up; "
      "take "
      "a larger system or a shorter cutoff",
      too_narrow_, trials_);
}

void MonteCarloBarostat::adapt() {
  const double by = 1 + std::min(0.1, 2.0 / static_cast<double>(++adapted_));
  if (taken_ < 0.25 * kTrials) largest_ /= by;
  if (taken_ > 0.75 * kTrials) largest_ *= by;
  tried_ = taken_ = 0;
}

}  // namespace taut
