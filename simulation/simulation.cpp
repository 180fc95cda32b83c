#include "simulation/simulation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/words.hpp"
#include "constraints/bond_algebra.hpp"
#include "ensembles/bussi.hpp"
#include "forcefield/check_positions.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "md/units.hpp"
#include "simulation/fixed_momenta.hpp"
#include "simulation/inner.hpp"
#include "simulation/moving_bonds.hpp"
#include "simulation/redundant_bonds.hpp"
#include "simulation/soft_start.hpp"
#include "simulation/unresolved_motion.hpp"
#include "systems/molecules/linked_rings.hpp"

namespace taut {
namespace {

// Fixman's potential as one of the scene's forces; null where it is not asked for.
std::shared_ptr<MetricField> add_metric_correction(Scene& scene) {
  if (!scene.run.metric_correction) return nullptr;
  if (scene.system.bond_count() == 0)
    throw InputError("run.metric_correction: there are no rigid bonds to correct for; leave it out");
  auto field = std::make_shared<MetricField>(scene.system, kBoltzmann * scene.run.temperature_k);
  scene.terms.own.push_back(field);
  return field;
}

bool same_thermostat(const RunSettings& a, const RunSettings& b) {
  return a.langevin() == b.langevin() && a.rescaling() == b.rescaling() &&
         a.temperature_k == b.temperature_k && a.temperature_course == b.temperature_course &&
         a.thermostat_ps == b.thermostat_ps && a.friction_per_ps == b.friction_per_ps &&
         a.remove_momentum_every == b.remove_momentum_every;
}

bool same_barostat(const RunSettings& a, const RunSettings& b) {
  return a.barostat == b.barostat && a.pressure_bar == b.pressure_bar &&
         a.barostat_every == b.barostat_every && a.barostat_ps == b.barostat_ps &&
         a.compressibility_per_bar == b.compressibility_per_bar && a.coupling == b.coupling &&
         (a.barostat == "none" ||
          (a.temperature_k == b.temperature_k && a.temperature_course == b.temperature_course));
}

constexpr int kAtomsWorthMeasuring = 1000;  // whose steps take so long that reading the clock does not show

}  // namespace

void refuse_springs_under_metric(const ConstraintMethod& method) {
  if (method.holds() == ConstraintMethod::Holds::kSprings)
    throw InputError(
        "run.metric_correction: corrects for rigid bonds, and those of method.name = \"penalty\" are "
        "springs");
}

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

Simulation::Inner::Inner(Scene& scene)
    : metric(add_metric_correction(scene)),
      forces(ForceField(scene.system, scene.start.box, scene.terms)),
      anchors(scene.system, scene.motions),
      projector(scene.system),
      drift(scene.system) {}

Simulation::~Simulation() = default;

Simulation::Simulation(Scene scene, const ThreadScope&)
    : threads_(available_threads()),
      full_(scene.system),
      redundancy_(find_redundancy(scene.system, scene.start.x)),
      scene_(without_redundant_bonds(std::move(scene), redundancy_)),
      inner_((hear(), std::make_unique<Inner>(scene_))),
      method_((hear(), make_method(scene_.system, scene_.method, scene_.run.h()))),
      state_(scene_.start),
      measures_parts_(scene_.system.atoms() >= kAtomsWorthMeasuring) {
  const System& sys = scene_.system;
  refuse_momentum_of_anchored_bonds(scene_);
  if (inner_->metric) refuse_springs_under_metric(*method_);
  refuse_method_of_moved_bonds(sys, inner_->anchors, scene_.method, *method_);
  refuse_thermostat_of_moved_bonds(sys, inner_->anchors, scene_.run);
  if (scene_.terms.worked_in_time()) inner_->ensemble.steering.emplace(inner_->forces.evaluation);
  size_sums();
  make_thermostat();
  bring_to_the_bonds(
      {.force = scene_.run.minimise ? scene_.run.minimise_force : 0, .soft = scene_.run.soft_start});
  note_start();
  refuse_unreachable_tolerance(sys, state_.x, method_->promised_error());
  count_degrees_of_freedom(fixed_motions(scene_, state_.x, state_.v));
  make_barostat();
  if (!scene_.run.tension_of.empty()) inner_->held.emplace(full_, sys, scene_.run);
  unaccounted_at_start_ = unaccounted();
}

void Simulation::bring_to_the_bonds(const MinimiseGoal& goal, const OnMove& on_move) {
  const System& sys = scene_.system;
  hear();
  place_sites(sys.sites, state_.x);
  if (goal.force > 0 && goal.soft) start_report_.pushed_apart = push_apart(scene_, state_, on_move);
  if (goal.force > 0) start_report_.minimised = minimise(sys, inner_->forces.field, goal, state_, on_move);
  leave_out_prescribed_velocities(scene_.motions, inner_->anchors, state_);
  start_report_.anchors_stopped = rest_anchors(sys, state_.v);
  if (scene_.run.remove_momentum_every > 0) {
    start_report_.centre_stopped = momentum(sys, state_.v).norm() / sys.mass.sum();
    remove_momentum(sys, state_.v);
  }
  const Vectors x = state_.x;
  const double kinetic = kinetic_energy(sys, state_.v);
  initialize(*inner_->integrator, inner_->dynamics(sys, *method_), scene_.run.h(), state_);
  if (inner_->ensemble.steering) inner_->ensemble.steering->begin();
  if (!state_.f.allFinite()) refuse_atoms_in_one_place(state_.box, state_.x);
  hear();
  start_report_.largest_move = x.cols() > 0 ? (state_.x - x).colwise().norm().maxCoeff() : 0.0;
  if (kinetic > 0) start_report_.kinetic_removed = 1 - kinetic_energy(sys, state_.v) / kinetic;
}

void Simulation::size_sums() {
  sums_.walls.resize(scene_.terms.walls.size());
  sums_.biases.resize(scene_.terms.biases.size());
  sums_.tension.resize(scene_.run.tension_of.empty() ? 0 : 1);
}

// From here on, of the log's rows and of the energy's account.
void Simulation::begin_means() {
  count_degrees_of_freedom(fixed_motions(scene_, state_.x, state_.v));
  const long last_row = std::exchange(sums_, LogSums{}).last_row;
  sums_.last_row = last_row;
  size_sums();
  unaccounted_at_start_ = unaccounted();
  heat_at_start_ = inner_->integrator->account.heat;
  work_from_outside_at_start_ = work_from_outside();
}

// For the header.
void Simulation::note_start() {
  if (const auto& nonbonded = scene_.terms.nonbonded;
      nonbonded && nonbonded->pme && !nonbonded->charge.isZero(0))
    ewald_doubt_ = doubt_of(chosen_parameters(*nonbonded->pme, state_.box, *nonbonded->cutoff), state_.box,
                            *nonbonded->cutoff);
  if (!ewald_doubt_.empty()) scene_.notes.push_back(ewald_doubt_);
  if (holds_centre(scene_) && scene_.run.remove_momentum_every > 1)
    scene_.notes.push_back(
        "run.remove_momentum_every: the centre of mass is held at every step, since anchors or forces from "
        "outside give momentum back in between; 0 leaves it alone");
  const auto& [pushed_apart, minimised, largest_move, centre_stopped, kinetic_removed, anchors] =
      start_report_;
  if (!anchors.empty())
    scene_.notes.push_back(
        fmt::format("atom {}{} anchored (mass 0): the velocity it had was left out", anchors.front(),
                    anchors.size() > 1 ? fmt::format(" and {} more are", anchors.size() - 1) : " is"));
  if (pushed_apart)
    scene_.notes.push_back(
        fmt::format("overlapping atoms pushed apart in {} by soft forces", counted(*pushed_apart, "move")));
  if (minimised)
    scene_.notes.push_back(
        fmt::format("minimised in {} from {:.6g} to {:.6g} kJ/mol, largest force {:.4g} kJ/mol/nm",
                    counted(minimised->moves, "move"), minimised->energy_before, minimised->energy,
                    minimised->largest_force));
  constexpr double kNoise = 1e-6;
  if (centre_stopped > kNoise)
    scene_.notes.push_back(
        fmt::format("run.remove_momentum_every: the centre of mass moved at {:.2g} nm/ps and was stopped",
                    centre_stopped));
  std::vector<std::string> what;
  if (largest_move > kNoise) what.push_back(fmt::format("atoms moved by up to {:.2g} nm", largest_move));
  if (kinetic_removed > kNoise && !scene_.velocities_drawn)  // else along the bonds, as it has to be
    what.push_back(fmt::format("{:.3g} % of the kinetic energy taken out", 100 * kinetic_removed));
  if (!what.empty()) scene_.notes.push_back(fmt::format("brought to the bonds: {}", fmt::join(what, ", ")));
  note_unresolved_motion();
  if (std::string linked = linked_rings_message(full_, scene_.terms, state_); !linked.empty())
    scene_.notes.push_back(std::move(linked));
  for (std::string& note : contradicted_lengths(full_, redundancy_.redundant, state_.x))
    scene_.notes.push_back(std::move(note));
}

// Of the step that there is.
void Simulation::note_unresolved_motion() {
  if (!unresolved_.empty()) std::erase(scene_.notes, unresolved_);
  unresolved_ = unresolved_motion(scene_, state_.x, has_springs());
  if (!unresolved_.empty()) scene_.notes.push_back(unresolved_);
}

void Simulation::make_thermostat() {
  const RunSettings& run = scene_.run;
  inner_->ensemble.thermostat.reset();
  inner_->ensemble.temperature = run.temperature_course;
  inner_->ensemble.remove_momentum_every = run.remove_momentum_every;
  inner_->forces.holds_centre = holds_centre(scene_);
  const Account account = inner_->integrator->account;
  if (run.langevin())
    inner_->integrator =
        std::make_unique<Langevin>(scene_.system,
                                   Langevin::Settings{.temperature = run.temperature_k,
                                                      .friction = run.friction_per_ps,
                                                      .seed = seed_here(),
                                                      .hold_momentum = run.remove_momentum_every > 0,
                                                      .springs = has_springs() ? method_.get() : nullptr,
                                                      .course = run.temperature_course},
                                   run.h());
  else
    inner_->integrator = std::make_unique<VelocityVerlet>();
  inner_->integrator->account = account;
}

void Simulation::make_barostat() {
  inner_->ensemble.barostat = taut::make_barostat(scene_, ~seed_here(), inner_->forces);
}

// What is drawn from here on was not drawn before: a thermostat taken away and given back.
std::uint64_t Simulation::seed_here() const {
  return scene_.run.seed + static_cast<std::uint64_t>(progress_.step) * 0x9e3779b97f4a7c15;
}

void Simulation::count_degrees_of_freedom(RigidMotions::Which fixed) {
  const System& sys = scene_.system;
  const RunSettings& run = scene_.run;
  fixed_ = fixed;
  const RigidMotions motions(fixed, sys, state_.x);
  dof_ = degrees_of_freedom(sys, has_springs() && run.langevin() ? 0 : sys.bond_count(),
                            InverseMetric(motions.of_all(sys, state_.x)).rank);
  if ((run.rescaling() || run.langevin()) && dof_.total() < 1)
    throw InputError("run.thermostat: nothing can move, there is no temperature");
  temperatures_.emplace(sys, scene_.terms, state_.x, dof_.rank > 0, motions);
  if (run.rescaling())
    inner_->ensemble.thermostat =
        std::make_unique<VelocityRescaling>(sys, VelocityRescaling::Settings{.temperature = run.temperature_k,
                                                                             .relaxation = run.thermostat_ps,
                                                                             .dof = dof_.total(),
                                                                             .seed = seed_here()});
}

// A spring's multipliers are of its positions; a constraint's are solved for: those of a method's last solve
// belong to the step before, or to a half of one.
Eigen::VectorXd Simulation::multipliers(const State& of) const {
  return has_springs() ? method_->lambda() : inner_->multipliers(scene_.system, of);
}

Eigen::VectorXd Simulation::bond_tensions() const {
  const ThreadScope own(threads_);
  return tensions(full_, least_norm_multipliers(full_, state_.x, redundancy_.redundant,
                                                multipliers(without_constraint_forces())));
}

Energies Simulation::energies() const {
  const ThreadScope own(threads_);
  return inner_->forces.field.energies(state_, inner_->forces.evaluation);
}

int Simulation::clusters() const {
  return inner_->projector.clusters();
}

double Simulation::unaccounted(double kinetic) const {
  const auto& [work, heat] = inner_->integrator->account;
  return kinetic + method_->spring_energy(scene_.system, state_.x) - work - heat - inner_->anchors.work();
}

double Simulation::unaccounted() const {
  const ThreadScope own(threads_);
  return unaccounted(kinetic_energy(scene_.system, velocity()));
}

State Simulation::state_to_write() const {
  State s = state_;
  place_site_velocities(scene_.system.sites, s.x, s.v);
  return s;
}

Vectors Simulation::without_stretching(Vectors v) const {
  if (method_->holds() != ConstraintMethod::Holds::kAll)
    inner_->projector.velocities(scene_.system, state_.x, v);
  return v;
}

Vectors Simulation::velocity() const {
  const ThreadScope own(threads_);
  return has_springs() ? state_.v : without_stretching(state_.v);
}

Vectors Simulation::kicked_velocity() const {
  Vectors v;
  find_kicked_velocity(scene_.system, scene_.run.h(), state_, v);
  return v;
}

Vectors Simulation::thermal_velocity() const {
  const ThreadScope own(threads_);
  if (has_springs() && inner_->langevin()) return kicked_velocity();
  return inner_->drift.of(scene_.run.h(), state_);
}

Record Simulation::record(const Vectors& thermal) const {
  const ThreadScope own(threads_);
  Record r;
  r.step = progress_.step;
  r.t = state_.t;
  r.potential = inner_->forces.field.potential(state_, inner_->forces.evaluation) +
                method_->spring_energy(scene_.system, state_.x);
  r.kinetic = kinetic_energy(scene_.system, velocity());
  r.temperature = temperature(kinetic_energy(scene_.system, thermal), dof_.total());
  r.full_step_temperature = temperature(r.kinetic, dof_.total());
  r.bonds = bond_errors(scene_.system, state_.x);
  return r;
}

std::optional<Eigen::Matrix3d> Simulation::pressure_tensor(const Vectors& thermal) const {
  if (!state_.box.periodic()) return {};
  const ThreadScope own(threads_);
  const State now{state_.x,
                  has_springs() ? kicked_velocity() : thermal,  // in which springs' motion has its part
                  state_.F, state_.t, state_.box};
  return pressure(scene_.system, inner_->forces.field, now, inner_->forces.evaluation, multipliers(now));
}

double Simulation::constraint_work() const {
  return unaccounted() - unaccounted_at_start_;
}

void Simulation::change(const RunSettings& run) {
  const ThreadScope own(threads_);
  refuse_thermostat_of_moved_bonds(scene_.system, inner_->anchors, run);
  const RunSettings before = std::exchange(scene_.run, run);
  if (inner_->metric) inner_->metric->set_kT(kBoltzmann * run.temperature_k);
  if (same_thermostat(before, run) && same_barostat(before, run)) return;
  if (!same_barostat(before, run)) make_barostat();
  std::string drawn;  // the numbers of a thermostat that stays go on
  Archive save = Archive::saving_to(drawn);
  const bool same_kind = before.langevin() == run.langevin() && before.rescaling() == run.rescaling();
  if (same_kind) save(*inner_->integrator);
  if (same_kind && inner_->ensemble.thermostat) save(*inner_->ensemble.thermostat);
  make_thermostat();
  begin_means();
  Archive load = Archive::loading_from(drawn);
  if (same_kind) load(*inner_->integrator);
  if (same_kind && inner_->ensemble.thermostat) load(*inner_->ensemble.thermostat);
}

// The thing itself is made anew, from the same scene; this is what its steps have changed.
void Simulation::serialize(Archive& archive) {
  const ThreadScope own(threads_);
  serialize_numbers(archive);
  if (!archive.loading()) return;
  State evaluated = state_;
  inner_->forces.evaluate(scene_.system, evaluated);
  state_.F.swap(evaluated.f);
}

void Simulation::serialize_numbers(Archive& archive) {
  int fixed = static_cast<int>(fixed_);  // as it was when the thermostat was changed
  auto& [x, v, f, t, box, F] = state_;   // does not compile where a member is left out
  archive(x, v, f, t, box, progress_, fixed);
  if (archive.within_process()) archive(F);  // from a file it is evaluated
  archive.demand(0 <= fixed && fixed <= static_cast<int>(RigidMotions::Which::kAllThatMoveNoAnchor));
  archive.demand_count(progress_.step);
  archive.demand_count(progress_.since_row.iterations);
  if (RigidMotions::Which(fixed) != fixed_) count_degrees_of_freedom(RigidMotions::Which(fixed));
  archive(sums_);
  archive.demand(0 <= sums_.last_row && sums_.last_row <= progress_.step && 0 <= sums_.rows &&
                 sums_.rows <= progress_.step + 1 && sums_.rows <= sums_.steps);
  archive(*temperatures_, inner_->forces.field, unaccounted_at_start_, heat_at_start_);
  if (works_from_outside()) archive(work_from_outside_at_start_);
  archive(inner_->anchors);
  archive(*method_);
  archive(inner_->ensemble, inner_->integrator->account, *inner_->integrator);
}

void Simulation::restore(std::string_view kept) {
  Archive archive = Archive::loading_from(kept);
  try {
    serialize(archive);
  } catch (const SimulationFailure& e) {  // forces were evaluated
    throw InputError(e.what());
  }
  archive.finish();
}

}  // namespace taut
