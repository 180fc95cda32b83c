#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "md/step_parts.hpp"
#include "md/units.hpp"
#include "simulation/doubts.hpp"
#include "simulation/inner.hpp"
#include "simulation/redundant_bonds.hpp"

namespace taut {
namespace {

constexpr long kStepsPerSnapshot = 100;
constexpr long kStepsPerHearing = 4;
constexpr double kLeeway = 2;  // feedforward judges a bond by itself, where bonds are coupled

bool finite(const State& s) {
  return s.x.allFinite() && s.v.allFinite() && s.f.allFinite();
}

// λ extrapolated runs ahead of bonds that turn far in a step.
void explain_law(const MethodOptions& method, Diagnosis& d) {
  const auto* feedforward = method.get_if<Feedforward::Options>();
  const auto* baumgarte = method.get_if<Baumgarte::Options>();
  if ((feedforward ? feedforward->extrapolation : baumgarte ? baumgarte->extrapolation : 0) == 0) return;
  d.advice =
      "take a shorter step, or method.extrapolation = 0, which bears steps as long as shake's; newton where "
      "the "
      "bars of a linkage come into one line";
}

// It fails by its nature, whatever the scene: a bond turning at ω is too long by (ωh)²(ωt)²/8 of itself.
void explain_none(Diagnosis& d) {
  d.cause = "a bond ran off: with none nothing brings an error back, it grows as (time × step)²";
  d.advice = "baumgarte, which is none with feedback; or half the step, which lasts about twice the time";
}

}  // namespace

void Simulation::LogSums::add(const Record& r, double residual, long since_row) {
  if (rows == 0) first_t = r.t, first_energy = r.but_for_heat(), first_temperature = r.temperature;
  energy.add(r.t, r.but_for_heat(), since_row);
  constraint_work.add(r.t, r.constraint_work, since_row);
  temperature.add(r.temperature, since_row);
  ++rows;
  last_row = r.step;
  steps += since_row;
  largest_error = std::max(largest_error, r.bonds.max);
  largest_residual = std::max(largest_residual, residual);
  squares += static_cast<double>(since_row) * r.bonds.rms * r.bonds.rms;
  for (std::size_t w = 0; w < walls.size(); ++w) walls[w].add(r.walls[w], since_row);
  for (std::size_t b = 0; b < biases.size(); ++b) {
    biases[b].value.add(r.biases[b].value, since_row);
    biases[b].force.add(r.biases[b].force, since_row);
    biases[b].lost += r.biases[b].lost;
  }
  for (RunningMean& mean : tension) mean.add(r.held->tension, since_row);
  if (!r.pressure) return;
  pressure.add(*r.pressure, since_row);
  volume.add(r.volume, since_row);
  density.add(r.density, since_row);
  const auto tensor = six_of(r.pressure_tensor);
  for (std::size_t k = 0; k < tensor.size(); ++k) pressure_tensor[k].add(tensor[k], since_row);
}

// From kJ/mol/ps of the whole.
double Simulation::per_ns_and_dof() const {
  return 1000.0 / std::max(1, dof_.total());
}

// The first row stands for as many steps as the one that follows it, which may be the end's.
long Simulation::steps_since_row() const {
  if (progress_.step > sums_.last_row) return progress_.step - sums_.last_row;
  return std::clamp(scene_.run.steps - progress_.step, 1L, scene_.run.log_every);
}

// As temperatures and the pressure, of the velocity of the drift, whose mean square is the bath's at any step. Bonds that
// were left out share the load with those they follow from, as in bond_tensions.
HeldTension Simulation::held_tension(const Vectors& thermal) const {
  const State now{state_.x, thermal, state_.F, state_.t, state_.box};
  return inner_->held->of(least_norm_multipliers(full_, state_.x, redundancy_.redundant, multipliers(now)),
                          has_springs() ? nullptr : &inner_->projector);
}

double Simulation::work_from_outside() const {
  return inner_->anchors.work() + (inner_->ensemble.steering ? inner_->ensemble.steering->work() : 0);
}

Record Simulation::full_record(const Vectors& thermal) const {
  const ThreadScope own(threads_);
  Record r = record(thermal);
  if (scene_.run.thermostatted() || scene_.run.remove_momentum_every > 0)
    r.heat = inner_->integrator->account.heat - heat_at_start_;
  r.walls = inner_->forces.evaluation.wall_pushes;
  r.biases = inner_->forces.evaluation.biases.readings;
  for (std::size_t b = 0; b < r.biases.size(); ++b)
    if (scene_.terms.biases[b].angular()) r.biases[b].value *= 180 / std::numbers::pi;
  if (state_.box.periodic())
    for (std::size_t w = 0; w < r.walls.size(); ++w)
      r.walls[w] *= kBarPerUnit * state_.box.edge[scene_.terms.walls[w].axis] / state_.box.volume();
  if (scene_.run.thermostatted()) r.bath_temperature = scene_.run.bath_temperature(state_.t);
  if (works_from_outside()) r.steering_work = work_from_outside() - work_from_outside_at_start_;
  if (scene_.terms.steered_in_time()) r.steering_force = inner_->forces.evaluation.steering.force;
  if (!scene_.motions.empty())
    r.motions = inner_->anchors.powers(
        scene_.system,
        scene_.system.one_sided.empty() ? multipliers(without_constraint_forces()) : method_->lambda(),
        state_);
  if (inner_->held) r.held = held_tension(thermal);
  r.constraint_work = unaccounted(r.kinetic) - unaccounted_at_start_;
  if (const auto tensor = pressure_tensor(thermal)) {
    r.pressure_tensor = *tensor;
    r.pressure = tensor->trace() / 3;
    r.volume = state_.box.volume();
    r.density = kDensityPerUnit * scene_.system.mass.sum() / r.volume;
  }
  return r;
}

// The row of the log for the state as it is.
Record Simulation::row(const Vectors& thermal, const SolveStats& since_row, double seconds, long steps) {
  Record r = full_record(thermal);
  RunningSlope energy = sums_.energy;
  energy.add(r.t, r.but_for_heat(), steps_since_row());
  r.drift = inner_->ensemble.barostat ? kUnknown : energy.value() * per_ns_and_dof();
  const long gone = r.step - sums_.last_row;
  r.iterations = gone > 0 ? static_cast<double>(since_row.iterations) / static_cast<double>(gone) : 0.0;
  r.ns_per_day = steps > 0 ? static_cast<double>(steps) * scene_.run.h() * 1e-3 * 86400 / seconds : 0.0;
  if (!std::isfinite(r.total()))
    throw SimulationFailure(
        r.step == 0
            ? "the start: its energy is no number; see which atoms are too near, or give run.minimise = true"
            : fmt::format("step {}: the energy is no longer a number; take a shorter step", r.step));
  return r;
}

SolveStats Simulation::take_step() {
  const ListenScope deaf;  // no clock is to show in a step's time
  ++progress_.step;
  return inner_->integrator->advance(inner_->dynamics(scene_.system, *method_), scene_.run.h(), state_);
}

Summary Simulation::run(const std::function<void(const Record&)>& on_record,
                        const std::function<void(long)>& on_step) {
  const ThreadScope own(threads_);
  const long first = progress_.step, steps = scene_.run.steps, log_every = scene_.run.log_every;
  if (log_every < 1) throw InputError(fmt::format("run.log_every is {}, expected 1 or more", log_every));
  const bool foreign = runs_foreign_code();
  bool in_step = false;  // foreign code may act, and what is thrown is taken back
  taken_back_.reset();
  Record last;
  PartMeter meter(threads_, measures_parts_ ? PartMeter::Parts::kAll : PartMeter::Parts::kBonds);
  double watching = 0;  // time that is not the steps' [s]
  const auto seconds = [&] { return meter.seconds() - watching; };
  const auto observe = [&](const SolveStats& since_row) {
    const double before = meter.seconds();
    in_part(StepPart::kLog, [&] {
      const Vectors thermal = thermal_velocity();
      last = row(thermal, since_row, seconds(), progress_.step - first);
      in_step = false;
      temperatures_->see(scene_.system, state_.x, thermal, steps_since_row());
      const bool as_drawn =
          sums_.rows == 0 && last.step == 0 && (scene_.velocities_drawn || state_.v.isZero(0));
      if (sums_.rows == 0) temperatures_->set_first(scene_.system, state_.x, as_drawn ? velocity() : thermal);
      sums_.add(last, since_row.max_residual, steps_since_row());
      if (as_drawn) sums_.first_temperature = last.full_step_temperature;
    });
    if (on_record) in_part(StepPart::kOutput, [&] { on_record(last); });
    watching += meter.seconds() - before;
  };
  stop_ = false;
  if (progress_.step == 0 && sums_.rows == 0) observe({});

  if (!foreign) keep_snapshot();
  try {
    while (!stop_ && progress_.step < steps) {
      if (foreign) note(), in_step = true;
      const SolveStats stats = take_step();
      const long step = progress_.step;
      const bool seen = step % log_every == 0;
      if (!stats.held() || (seen && !(state_.x.allFinite() && state_.f.allFinite())))
        throw StepFailure(taut::diagnose(scene_.system, state_, stats, step), stats);
      progress_.since_row += stats;
      if (seen) observe(std::exchange(progress_.since_row, {}));
      if (foreign)
        expect_numbers();
      else if (step % kStepsPerSnapshot == 0)
        keep_snapshot();
      in_step = false;
      if (step % kStepsPerHearing == 0) hear();
      if (on_step) in_part(StepPart::kOutput, [&] { on_step(step); });
    }
  } catch (const SimulationFailure& failure) {
    if (!in_step) throw;
    const auto* step = dynamic_cast<const StepFailure*>(&failure);
    taken_back_ = step ? explained(step->stats, {}) : explained({}, failure.what());
    take_back(*taken_back_);
    throw;
  } catch (...) {
    if (in_step) take_back();
    throw;
  }

  const bool ended = progress_.step >= steps;
  if (ended && sums_.last_row != progress_.step)
    observe(progress_.since_row);  // a row more, after what a checkpoint keeps
  else
    last = row(thermal_velocity(), progress_.since_row, seconds(), progress_.step - first);
  const LogSums sums = sums_;
  if (sums.rows == 0)
    sums_.add(last, progress_.since_row.max_residual, steps_since_row());  // means have just begun again
  const Summary all = summary(last, seconds(), meter, progress_.step - first);
  sums_ = sums;
  return all;
}

// A thermostat takes ½kδT·r off a degree of freedom that is δT too warm, r = 1/τ where it rescales, 2γ of
// Langevin's: that balances the drift, of which the bonds' share alone is known under a barostat. None
// without thermostat [K].
std::optional<double> Simulation::off_by_k(double drift) const {
  const RunSettings& run = scene_.run;
  if (!run.thermostatted()) return {};
  const double rate = run.langevin() ? 2 * run.friction_per_ps : 1 / run.thermostat_ps;  // [1/ps]
  const double a_step = -std::expm1(-rate * run.h());  // the share of the excess that a step takes
  return 2 * drift / 1000 * run.h() / (kBoltzmann * a_step);
}

// What the forces could do over the system's size, and have done: where all is at rest there is no other [kJ/mol].
double Simulation::energy_scale(double potential) const {
  if (state_.x.cols() == 0) return 0;
  const Vec3 middle = state_.x.rowwise().mean();
  const double size = (state_.x.colwise() - middle).colwise().norm().maxCoeff();
  return std::abs(potential) + size * state_.F.colwise().norm().sum();
}

StartAndEnd Simulation::start_and_end(const Record& end) const {
  constexpr double kRounding = 1e-6;
  const RunSettings& run = scene_.run;
  const double relaxation = run.langevin() ? 1 / (2 * run.friction_per_ps) : run.thermostat_ps;
  std::vector<KindOfMolecule> kinds;
  for (int type = 0; type < static_cast<int>(temperatures_->types().size()); ++type)
    kinds.push_back(temperatures_->later_half(type));
  return {.time = end.t - sums_.first_t,
          .rise = inner_->ensemble.barostat
                      ? kUnknown
                      : (end.but_for_heat() - sums_.first_energy) / std::max(1, dof_.total()),
          .rounding = kRounding * energy_scale(end.potential) / std::max(1, dof_.total()),
          .dof = dof_.total(),
          .expected = !run.temperature_course.empty()
                          ? run.temperature_course.mean((sums_.first_t + end.t) / 2, end.t)
                      : run.thermostatted() ? run.temperature_k
                                            : sums_.first_temperature,
          .temperature = sums_.temperature.later_half(),
          .relaxation = run.thermostatted() ? relaxation : 0,
          .worked_on = !scene_.closed_but_for_restraints() || !scene_.terms.biases.empty(),
          .loses_energy = !scene_.system.one_sided.empty(),
          .kinds = std::move(kinds)};
}

Summary Simulation::summary(const Record& end, double seconds, const PartMeter& meter, long steps) const {
  const double taken = static_cast<double>(std::max(1L, steps));
  Summary s;
  s.steps = progress_.step;
  if (steps == 0) seconds = 0;  // no step, no speed
  s.us_per_step = seconds / taken * 1e6;
  s.constraint_us_per_step = meter.seconds_of(StepPart::kBonds) / taken * 1e6;
  s.timings = {steps, threads_, meter.times()};
  s.ns_per_day = end.ns_per_day;
  s.max_rel_bond_error = sums_.largest_error;
  s.rms_rel_bond_error = std::sqrt(sums_.squares / static_cast<double>(sums_.steps));
  const auto drift = [&](const RunningSlope& of) {
    const Estimate slope = of.estimate();
    return Estimate{slope.value * per_ns_and_dof(), slope.error * per_ns_and_dof()};
  };
  s.drift = inner_->ensemble.barostat ? Estimate{kUnknown, 0} : drift(sums_.energy);
  s.constraint_drift = drift(sums_.constraint_work);
  s.constraint_work = end.constraint_work;
  s.heat = end.heat;
  s.off_by_k = off_by_k((inner_->ensemble.barostat ? s.constraint_drift : s.drift).value);
  s.temperature = sums_.temperature.estimate().value;
  s.start_and_end = start_and_end(end);
  if (state_.box.periodic()) {
    s.pressure = sums_.pressure.estimate();
    s.volume = sums_.volume.estimate();
    s.density = sums_.density.estimate();
    for (std::size_t k = 0; k < kTensorNames.size(); ++k)
      s.pressure_tensor[k] = sums_.pressure_tensor[k].estimate();
  }
  for (const RunningMean& wall : sums_.walls) s.walls.push_back(wall.estimate());
  for (const auto& [value, force, lost] : sums_.biases)
    s.biases.push_back({value.estimate(), force.estimate(), lost});
  for (const RunningMean& mean : sums_.tension) s.tension = mean.estimate();
  s.steering_work = end.steering_work;
  s.potential = end.potential;
  s.total = end.total();
  if (std::isfinite(method_->promised_error()))
    s.converged =
        std::max(sums_.largest_residual, s.max_rel_bond_error) <= kLeeway * method_->promised_error();
  s.doubts = doubts(s);
  if (const std::string doubt = inner_->ensemble.doubt(); !doubt.empty()) s.doubts.push_back(doubt);
  for (std::size_t b = 0; b < s.biases.size(); ++b)
    if (s.biases[b].lost > 0)
      s.doubts.push_back(fmt::format(
          "bias {} did not act in {} of {} rows, where its centres coincide or lie in a line: give it a "
          "start, or groups, that do not",
          scene_.terms.biases[b].name, s.biases[b].lost, sums_.rows));
  if (!ewald_doubt_.empty()) s.doubts.push_back(ewald_doubt_);
  for (std::string& doubt : lost_lengths(full_, redundancy_.redundant, state_.x))
    s.doubts.push_back(std::move(doubt));
  return s;
}

void Simulation::expect_numbers() const {
  if (!finite(state_)) throw StepFailure(taut::diagnose(scene_.system, state_, {}, progress_.step), {});
}

// Where a failure is looked for from: see diagnose. Where numbers have run away already, the last one stays.
void Simulation::keep_snapshot() {
  const PartScope here(StepPart::kSnapshots);
  expect_numbers();
  snapshot_.clear();
  Archive archive = Archive::noting_in(snapshot_);
  serialize(archive);
}

std::optional<Diagnosis> Simulation::diagnose() {
  const ThreadScope own(threads_);
  if (runs_foreign_code()) return std::exchange(taken_back_, {});
  if (snapshot_.empty()) return {};
  const long failed = progress_.step;
  Archive archive = Archive::recalling(snapshot_);
  serialize(archive);
  std::optional<Diagnosis> found;
  while (!found && progress_.step < failed) {
    note();
    found = wrong_with_next_step();
  }
  if (found) take_back(*found);
  return found;
}

std::optional<Diagnosis> Simulation::wrong_with_next_step() {
  SolveStats stats;
  std::string thrown;  // by a force
  try {
    stats = take_step();
  } catch (const SimulationFailure& e) {
    thrown = e.what();
  }
  if (thrown.empty() && stats.held() && finite(state_) && std::isfinite(record().total())) return {};
  return explained(stats, thrown);
}

Diagnosis Simulation::explained(const SolveStats& stats, const std::string& thrown) const {
  Diagnosis d = taut::diagnose(scene_.system, state_, stats, progress_.step);
  if (!thrown.empty()) {  // "what; what to do", or what alone
    const std::size_t end = thrown.find("; ");
    d.cause = thrown.substr(0, end);
    if (end != std::string::npos) d.advice = thrown.substr(end + 2);
  }
  if (scene_.method.name() == "none" && stats.converged() && !stats.held()) explain_none(d);
  if (stats.failure == Failure::kSingularOrTurned) explain_law(scene_.method, d);
  return d;
}

}  // namespace taut
