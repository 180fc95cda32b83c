#include "systems/simulation.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "constraints/bond_algebra.hpp"
#include "constraints/projection.hpp"
#include "constraints/redundancy.hpp"
#include "md/errors.hpp"
#include "md/run.hpp"
#include "md/timed.hpp"

namespace taut {
namespace {

// Momentum is conserved where nothing outside pulls; it starts at zero where the velocities were so drawn.
bool momentum_stays_zero(const Scene& scene, const Vectors& v) {
  if (scene.run.remove_momentum_every > 0) return true;
  if (!scene.closed() || scene.run.langevin()) return false;
  const double kinetic = kinetic_energy(scene.system, v);
  return kinetic > 0 &&
         momentum(scene.system, v).norm() < 1e-6 * std::sqrt(2 * kinetic * scene.system.mass.sum());
}

// The scene with the bonds left out that follow from others, where that was asked for.
Scene reduced(Scene scene, const Redundancy& redundancy) {
  if (redundancy.none()) return scene;
  if (!redundancy.degenerate.empty() || scene.run.redundant != "drop")
    throw InputError(fmt::format("{}: {}", scene.name, explain(redundancy, scene.system)));
  scene.system = without(scene.system, redundancy.redundant);
  scene.notes.push_back(
      fmt::format("{} bonds left out that follow from others", redundancy.redundant.size()));
  return scene;
}

// A coordinate is known to 1e-16 of itself, so a bond's length to no better than that over its length.
void refuse_unreachable_tolerance(const System& sys, const Vectors& x, double tolerance) {
  if (sys.bonds.empty()) return;
  double shortest = sys.bonds[0].length;
  for (const auto& bond : sys.bonds) shortest = std::min(shortest, bond.length);
  const double floor = 2 * std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff() / shortest;
  if (tolerance < floor)
    throw InputError(
        fmt::format("method.tolerance: {:g} cannot be reached, rounding alone leaves {:.1e} on a bond of "
                    "{:g} nm; take {:.0e} or more",
                    tolerance, floor, shortest, 5 * floor));
}

}  // namespace

Simulation::Simulation(Scene scene)
    : full_(scene.system),
      redundancy_(find_redundancy(scene.system, scene.start.x)),
      scene_(reduced(std::move(scene), redundancy_)),
      forces_(scene_.system, scene_.terms),
      method_(make_method(scene_.system, scene_.method, scene_.run.h())),
      state_(scene_.start) {
  const System& sys = scene_.system;
  const RunSettings& run = scene_.run;
  if (run.langevin()) make_langevin();
  visit_step([&](auto& method, auto& bath) { initialize(sys, forces_, method, state_, bath); });
  clusters_ = Projector(sys).clusters();
  dof_ = degrees_of_freedom(sys, has_springs() && run.langevin() ? 0 : sys.bond_count(),
                            momentum_stays_zero(scene_, state_.v));
  refuse_unreachable_tolerance(sys, state_.x, promised_error());
  if ((run.rescaling() || run.langevin()) && dof_.total() < 1)
    throw InputError("run.thermostat: nothing can move, there is no temperature");
  if (run.rescaling()) thermostat_.emplace(run.temperature_k, run.thermostat_ps, dof_.total(), run.seed);
}

void Simulation::make_langevin() {
  const RunSettings& run = scene_.run;
  langevin_.emplace(scene_.system,
                    Langevin::Bath{.temperature = run.temperature_k,
                                   .friction = run.friction_per_ps,
                                   .seed = run.seed,
                                   .free_bonds = has_springs(),
                                   .hold_momentum = run.remove_momentum_every > 0},
                    run.h());
}

// visit(method, bath), as md/step.hpp takes them.
void Simulation::visit_step(auto&& visit) {
  NoBath none;
  std::visit([&](auto& method) { langevin_ ? visit(method, *langevin_) : visit(method, none); }, method_);
}

bool Simulation::has_springs() const {
  return std::holds_alternative<Penalty>(method_);
}

double Simulation::promised_error() const {
  return std::visit([](const auto& method) { return method.promised_error(); }, method_);
}

std::string Simulation::method_setting() const {
  return std::visit([](const auto& method) { return method.setting(); }, method_);
}

Eigen::VectorXd Simulation::bond_tensions() const {
  const auto& lambda =
      std::visit([](const auto& method) -> const Eigen::VectorXd& { return method.lambda(); }, method_);
  return tensions(full_, least_norm_multipliers(full_, state_.x, redundancy_.redundant, lambda));
}

double Simulation::method_energy() const {
  return std::visit(
      [&](const auto& method) {
        if constexpr (requires { method.spring_energy(scene_.system, state_.x); })
          return method.spring_energy(scene_.system, state_.x);
        else
          return 0.0;
      },
      method_);
}

Vectors Simulation::thermal_velocity() const {
  return langevin_ ? langevin_->middle_velocity(scene_.system, state_) : state_.v;
}

Record Simulation::record() const {
  Record r;
  r.t = state_.t;
  r.potential = forces_.potential() + method_energy();
  r.kinetic = kinetic_energy(scene_.system, state_.v);
  r.temperature = temperature(kinetic_energy(scene_.system, thermal_velocity()), dof_.total());
  r.bonds = bond_errors(scene_.system, state_.x);
  return r;
}

Summary Simulation::run(const std::function<void(const Record&)>& on_record,
                        const std::function<void(long)>& on_step) {
  using Clock = std::chrono::steady_clock;
  const RunSettings& settings = scene_.run;
  const int dof = std::max(1, dof_.total());
  Summary summary;
  Slope energy;
  double squares = 0, temperatures = 0, watching = 0;
  long rows = 0, last = 0;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count() - watching; };

  const auto observe = [&](long step, const SolveStats& since) {
    const auto pause = Clock::now();
    const double spent = elapsed();
    Record r = record();
    r.step = step;
    energy.add(r.t, r.total());
    r.drift = energy.value() / dof * 1000;  // per ps to per ns
    r.iterations =
        step > last ? static_cast<double>(since.iterations) / static_cast<double>(step - last) : 0.0;
    r.ns_per_day = step > 0 ? static_cast<double>(step) * settings.h() * 1e-3 * 86400 / spent : 0.0;
    last = step;
    ++rows;
    summary.max_rel_bond_error = std::max(summary.max_rel_bond_error, r.bonds.max);
    squares += r.bonds.rms * r.bonds.rms;
    temperatures += r.temperature;
    if (!std::isfinite(r.total()))
      throw SimulationFailure(
          fmt::format("step {}: the energy is no longer a number; take a shorter step", step));
    if (on_record) on_record(r);
    watching += std::chrono::duration<double>(Clock::now() - pause).count();
    return r;
  };

  const RunPlan plan{.h = settings.h(),
                     .steps = settings.steps,
                     .observe_every = settings.log_every,
                     .remove_momentum_every = settings.remove_momentum_every};
  Record end = observe(0, {});
  double constraint_seconds = 0;
  long n = 0;
  visit_step([&](auto& method, auto& bath) {
    Timed timed(method);
    const auto each = [&](State& s) {
      if (thermostat_) (*thermostat_)(scene_.system, plan.h, s.v);
      if (on_step) on_step(++n);
    };
    taut::run(
        scene_.system, forces_, timed, plan, state_, each,
        [&](const Moment& m) { end = observe(m.step, m.since); }, bath);
    constraint_seconds = timed.seconds();
  });

  const double seconds = elapsed(), steps = static_cast<double>(std::max(1L, settings.steps));
  summary.steps = settings.steps;
  summary.us_per_step = seconds / steps * 1e6;
  summary.constraint_us_per_step = constraint_seconds / steps * 1e6;
  summary.ns_per_day = end.ns_per_day;
  summary.rms_rel_bond_error = std::sqrt(squares / static_cast<double>(rows));
  summary.drift = end.drift;
  summary.drift_error = energy.standard_error() / dof * 1000;
  summary.temperature = temperatures / static_cast<double>(rows);
  summary.potential = end.potential;
  summary.total = end.total();
  return summary;
}

}  // namespace taut
