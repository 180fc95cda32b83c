#include "simulation_object.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "forcefield/check_terms.hpp"

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kLookEvery = std::chrono::milliseconds(50);  // for Ctrl-C

struct Busy {
  explicit Busy(std::atomic<bool>& flag) : running(flag) { running = true; }
  ~Busy() { running = false; }
  std::atomic<bool>& running;
};

// Tells how far a minimisation is, too.
class InterruptsAndMoves : Interrupts {
 public:
  explicit InterruptsAndMoves(const py::object* progress) : progress_(progress) {}

  void operator()(const Minimised& so_far) {
    look([&] {
      if (!progress_->is_none()) (*progress_)(so_far.moves, so_far.energy, so_far.largest_force);
    });
  }

 private:
  const py::object* progress_;
};

// Python's names for the options of a run, in messages.
RunOptionNames option_names() {
  return {.folder = "out=\"a folder\"",
          .go_on = "Simulation.resume",
          .overwrite = "overwrite=True",
          .resume = "Simulation.resume",
          .accept = "resume(..., yes=True)"};
}

OpenRun open_new_run(Input input, const std::string& out, bool overwrite) {
  RunRequest request{.mode = overwrite && !out.empty() ? RunMode::kOverwrite : RunMode::kNew,
                     .folder = out,
                     .threads = input.threads,
                     .names = option_names(),
                     .scene = std::move(input.scene),
                     .source = std::move(input.source)};
  const ListenScope interrupted{Interrupts()};
  const py::gil_scoped_release interpreter;
  return open_run(std::move(request));
}

OpenRun open_resumed_run(RunRequest request, const py::list& forces) {
  if (request.threads) expect_threads("threads", *request.threads);
  request.names = option_names();
  request.forces = own_fields(forces);
  const ListenScope interrupted{Interrupts()};
  const py::gil_scoped_release interpreter;
  return open_run(std::move(request));
}

// True for Python's False and for numpy's.
bool is_false(const py::object& answer) {
  if (answer.is(py::bool_(false))) return true;
  return py::isinstance(answer, py::module_::import("numpy").attr("bool_")) && !answer.cast<bool>();
}

}  // namespace

PythonSimulation::PythonSimulation(Input input, const std::string& out, bool overwrite)
    : run_(open_new_run(std::move(input), out, overwrite)) {
  note_state();
}

PythonSimulation::PythonSimulation(RunRequest request, const py::list& forces)
    : run_(open_resumed_run(std::move(request), forces)) {
  note_state();
}

void PythonSimulation::run(long steps, long every, const Calls& calls, bool to_end) {
  expect_idle();
  if (closed_) throw std::runtime_error("it is closed; make another Simulation, or resume from a checkpoint");
  if (steps < 1 || steps > 1L << 50)
    throw InputError(fmt::format("run({}): expected 1 to 2**50 steps", steps));
  if (every < 0) throw InputError(fmt::format("run(every={}): expected 1 or more", every));
  take_over_changes();
  const Busy busy(running_);
  set_steps(run_.simulation->step() + steps + (to_end ? 0 : 1), every);
  const long first = run_.simulation->step(), last = first + steps;
  if (run_.folder) run_.folder->set_source(run_.source);
  if (run_.folder && !begun_) run_.folder->begin(*run_.simulation);
  begun_ = true;
  std::exception_ptr thrown;
  std::optional<Record> row;
  long next_report = calls.report.is_none() ? -1 : calls.first_report;
  auto next_look = Clock::now() + kLookEvery;
  stopped_ = false;
  const auto look = [&] {  // needs Python's interpreter lock
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const long step = run_.simulation->step();
      if (row && !calls.on_row.is_none())
        stopped_ |= is_false(call(calls.on_row, py::cast(Row{*std::exchange(row, {}), columns_}), step));
      if (step == next_report) {
        const py::object answer = call(calls.report, py::int_(step), step);
        stopped_ |= is_false(answer);
        next_report = is_false(answer) ? -1 : answer.cast<long>();
      }
      if (!calls.progress.is_none()) calls.progress(step);
    } catch (...) {
      thrown = std::current_exception();
      stopped_ = true;
    }
  };
  const RunWatch watch{.on_record =
                           [&](const Record& r) {
                             log_.append(r);
                             row = r;
                             if (r.step > first) return;
                             const py::gil_scoped_acquire interpreter;
                             look();
                             if (thrown) std::rethrow_exception(thrown);
                             if (stopped_) run_.simulation->stop();
                           },
                       .go_on =
                           [&](long step) {
                             const bool due = (row && !calls.on_row.is_none()) || step == next_report;
                             if (due || Clock::now() >= next_look) {
                               const py::gil_scoped_acquire interpreter;
                               next_look = Clock::now() + kLookEvery;
                               look();
                             }
                             return !stopped_ && (to_end || step < last);
                           }};
  forget_python_error();
  try {
    const Summary done = [&] {
      const py::gil_scoped_release interpreter;
      return take_steps(*run_.simulation, run_.folder ? &*run_.folder : nullptr, watch);
    }();
    summary_ =
        summary_json(*run_.simulation, done).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  } catch (const ExplainedFailure& failure) {
    note_state();
    rethrow_python_error();
    raise(failure);
  } catch (...) {
    note_state();
    rethrow_python_error();
    throw;
  }
  note_state();
  if (!thrown && row) look();
  if (thrown) std::rethrow_exception(thrown);
}

// What the function wrote before it threw an exception counts, too.
py::object PythonSimulation::call(const py::object& function, const py::object& argument, long step) {
  note_state();
  const Busy looked_at(in_callback_);
  const auto take_over = [&] {
    try {
      take_over_changes();
    } catch (const InputError& e) {
      undo_writing();
      throw InputError(fmt::format("the callback of step {}: {}; what it wrote is undone", step, e.what()));
    }
  };
  py::object answer;
  try {
    answer = function(argument);
  } catch (...) {
    const auto thrown = std::current_exception();
    try {
      take_over();
    } catch (...) {  // the first exception says more
    }
    std::rethrow_exception(thrown);
  }
  take_over();
  return answer;
}

void PythonSimulation::close() {
  expect_idle();
  run_.folder.reset();
  closed_ = true;
}

void PythonSimulation::set_box(const Eigen::Matrix3d& vectors) {
  expect_between_steps();
  expect_this_process();
  if (!run_.simulation->state().box.periodic())
    throw InputError("box: the system has none; make a Simulation with a box");
  if (run_.simulation->scene().system.images.periodic())
    throw InputError(
        "box: a cluster of rigid bonds goes around it to its own image, and bonds do not change with a box");
  if (const std::string flaw = Box::flaw(vectors); !flaw.empty()) throw InputError("box: " + flaw);
  const Box box = Box::of(vectors);
  if (const std::string flaw = lack_of_room(run_.simulation->scene().terms, box); !flaw.empty())
    throw InputError("box: " + flaw);
  expect_finite();
  const Box before = std::exchange(run_.simulation->state().box, box);
  try {
    set_out_anew();
  } catch (...) {
    run_.simulation->state().box = before;
    forces_outdated_ = true;
    throw;
  }
}

Minimised PythonSimulation::minimise(double force, long steps, const py::object& progress) {
  expect_idle();
  if (!(force > 0)) throw InputError(fmt::format("minimise({}): expected more than 0 kJ/mol/nm", force));
  if (steps < 1 || steps > std::numeric_limits<int>::max())
    throw InputError(fmt::format("minimise(steps={}): expected 1 or more", steps));
  expect_finite();
  const ListenScope interrupted{Interrupts()};
  set_out_anew({.force = force, .most_moves = static_cast<int>(steps)}, progress);
  return *run_.simulation->start_report().minimised;
}

std::vector<std::string> PythonSimulation::notes() const {
  std::vector<std::string> notes = run_.simulation->scene().notes;
  if (run_.folder && !run_.folder->note().empty()) notes.push_back(run_.folder->note());
  return notes;
}

py::bytes PythonSimulation::checkpoint(const std::string& history) {
  expect_between_steps();
  take_over_changes();
  Checkpoint checkpoint{.source = run_.source,
                        .step = run_.simulation->step(),
                        .t = run_.simulation->state().t,
                        .threads = run_.simulation->threads(),
                        .memory = {},
                        .marks = {},
                        .history = history};
  Archive archive = Archive::saving_to(checkpoint.memory);
  run_.simulation->serialize(archive);
  return to_bytes(checkpoint);
}

Simulation& PythonSimulation::settled() {
  expect_between_steps();
  take_over_changes();
  return *run_.simulation;
}

void PythonSimulation::expect_idle() const {
  if (running_ || setting_out_)
    throw std::runtime_error("it is running: in another thread, or this is its callback, force or method");
  expect_this_process();
}

// A forked process has none of its parent's threads.
void PythonSimulation::expect_this_process() const {
  if (getpid() != made_in_)
    throw std::runtime_error(
        "it was made in another process, before a fork; make it in this one, or start "
        "processes with multiprocessing's \"spawn\"");
}

void PythonSimulation::expect_between_steps() const {
  if (setting_out_ || (running_ && !in_callback_))
    throw std::runtime_error(
        "it is in the middle of a step: in another thread, or this is its force or method");
}

void PythonSimulation::set_steps(long steps, long every) {
  RunSettings settings = run_.simulation->scene().run;
  settings.steps = steps;
  if (every > 0) settings.log_every = every;
  run_.simulation->change(settings);
  KeyValues values = key_values(run_.source.overrides);
  values["run.steps"] = std::to_string(settings.steps);
  if (every > 0) values["run.log_every"] = std::to_string(every);
  run_.source.overrides = overrides_of(values);
}

void PythonSimulation::change(const std::vector<std::string>& overrides) {
  expect_idle();
  take_over_changes();
  forget_python_error();
  try {
    const ListenScope interrupted{Interrupts()};
    change_settings(*run_.simulation, run_.source, key_values(overrides));
  } catch (...) {
    rethrow_python_error();
    throw;
  }
  note_state();
}

void PythonSimulation::note_state() {
  forces_outdated_ = false;
  seen_.x = run_.simulation->state().x;
  seen_.v = run_.simulation->state().v;
  if (run_.simulation->state().box.periodic()) shown_->box = run_.simulation->state().box.vectors();
}

void PythonSimulation::expect_finite() const {
  const State& s = run_.simulation->state();
  for (const auto& [name, now] : {std::pair("positions", &s.x), std::pair("velocities", &s.v)})
    for (Eigen::Index a = 0; a < now->cols(); ++a)
      if (!now->col(a).allFinite())
        throw InputError(fmt::format("{}[{}]: {}, {}, {} was written there, expected finite numbers", name, a,
                                     (*now)(0, a), (*now)(1, a), (*now)(2, a)));
}

void PythonSimulation::take_over_changes() {
  const State& s = run_.simulation->state();
  if (s.x == seen_.x && s.v == seen_.v && !forces_outdated_) return;
  expect_this_process();
  expect_finite();
  set_out_anew();
}

void PythonSimulation::undo_writing() {
  run_.simulation->state().x = seen_.x;
  run_.simulation->state().v = seen_.v;
}

void PythonSimulation::set_out_anew(const MinimiseGoal& goal, const py::object& progress) {
  const Busy busy(setting_out_);
  const Vectors x = run_.simulation->state().x, v = run_.simulation->state().v;
  undo_writing();
  forget_python_error();
  try {
    std::optional<py::gil_scoped_release> long_work;
    if (goal.force > 0 && !run_.simulation->runs_foreign_code()) long_work.emplace();
    run_.simulation->set_out_anew(x, v, goal, InterruptsAndMoves(&progress));
  } catch (...) {
    rethrow_python_error();
    throw;
  }
  note_state();
}

void PythonSimulation::raise(const ExplainedFailure& failure) const {
  const Diagnosis& d = failure.diagnosis;
  const py::object error = python_class("taut.errors", "SimulationFailure")(py::str(failure.what()));
  const auto if_blamed = [&](py::object value) { return d.bond >= 0 ? value : py::none(); };
  error.attr("step") = d.step, error.attr("time_ps") = d.t;
  error.attr("cause") = d.cause, error.attr("advice") = d.advice;
  error.attr("bond") = if_blamed(py::int_(d.bond));
  error.attr("atoms") = if_blamed(py::make_tuple(d.held.i, d.held.j));
  error.attr("length_nm") = if_blamed(py::float_(d.length));
  error.attr("length_before_nm") = if_blamed(py::float_(d.length_before));
  error.attr("target_nm") = if_blamed(py::float_(d.held.length));
  error.attr("largest_force_kj_mol_nm") = d.largest_force, error.attr("atom") = d.atom;
  error.attr("positions") = rows_of(run_.simulation->state().x);
  error.attr("velocities") = rows_of(run_.simulation->state().v);
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
  throw py::error_already_set();
}

pid_t PythonSimulation::this_process() {
  return getpid();
}

}  // namespace taut
