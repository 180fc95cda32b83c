// What throws, a step or a new start, leaves the simulation as it was. Nothing of it is asked again: foreign
// code may have thrown because it was interrupted, or may throw again.

#include <utility>

#include "simulation/inner.hpp"
#include "simulation/moving_bonds.hpp"

namespace taut {

bool Simulation::runs_foreign_code() const {
  return scene_.method.method().added || scene_.foreign_fields();
}

void Simulation::note() {
  inner_->note.numbers.clear();
  Archive archive = Archive::noting_in(inner_->note.numbers);
  serialize_numbers(archive);
  inner_->note.evaluation = inner_->forces.evaluation;
}

void Simulation::take_back() {
  Archive archive = Archive::recalling(inner_->note.numbers);
  serialize_numbers(archive);
  inner_->forces.evaluation = inner_->note.evaluation;
}

void Simulation::take_back(Diagnosis& of) {
  take_back();
  if (of.bond >= 0) of.length_before = scene_.system.along(of.held, state_.x).norm();
}

void Simulation::set_out_anew(const Vectors& x, const Vectors& v, const MinimiseGoal& goal,
                              const OnMove& on_move) {
  const ThreadScope own(threads_);
  note();
  const StartReport report = start_report_;
  std::unique_ptr<ConstraintMethod> method = make_method(scene_.system, scene_.method, scene_.run.h());
  method.swap(method_);
  try {
    make_thermostat();  // it knows the method
    state_.x = x, state_.v = v;
    bring_to_the_bonds(goal, on_move);
    begin_means();
    if (!snapshot_.empty()) keep_snapshot();  // steps before are not taken again from here
  } catch (...) {
    method_ = std::move(method);
    make_thermostat();
    count_degrees_of_freedom(fixed_);
    take_back();
    start_report_ = report;
    throw;
  }
}

void Simulation::change_step(double dt_fs, const MethodOptions& method) {
  const ThreadScope own(threads_);
  const auto probe = make_method(scene_.system, method, dt_fs * 1e-3);
  if (inner_->metric) refuse_springs_under_metric(*probe);
  refuse_unreachable_tolerance(scene_.system, state_.x, probe->promised_error());
  refuse_method_of_moved_bonds(scene_.system, inner_->anchors, method, *probe);
  const double dt_before = std::exchange(scene_.run.dt_fs, dt_fs);
  const MethodOptions method_before = std::exchange(scene_.method, method);
  const Vectors x = state_.x, v = state_.v;
  try {
    set_out_anew(x, v);
  } catch (...) {
    scene_.run.dt_fs = dt_before, scene_.method = method_before;
    make_thermostat();  // it knows the step
    count_degrees_of_freedom(fixed_);
    take_back();
    throw;
  }
  note_unresolved_motion();
  make_barostat();
}

}  // namespace taut
