#pragma once

#include <atomic>
#include <vector>

#include "base/shared_rows.hpp"
#include "core.hpp"
#include "lent_state.hpp"
#include "simulation/log_columns.hpp"
#include "simulation/open_run.hpp"
#include "simulation/recorded_run.hpp"

namespace taut {

// A row of the log, and what its numbers are called.
struct Row {
  Record record;
  std::shared_ptr<const std::vector<LogColumn>> columns;
};

// The C++ side of taut.Simulation: a simulation with its folder and its log. It notices when Python code has
// written to the views of positions and velocities, and starts again from there before it answers anything
// else.
class PythonSimulation {
 public:
  PythonSimulation(Input input, const std::string& out, bool overwrite);
  PythonSimulation(RunRequest request, const py::list& forces);  // resumes
  ~PythonSimulation() { leave_to_views(run_.simulation->state(), *shown_); }

  // What a run calls in Python. Each may be None.
  struct Calls {
    py::object on_row;    // with each row of the log
    py::object progress;  // with the number of steps taken, every 50 ms
    // With the number of steps taken, after step `first_report` and then after each step that it returned last.
    py::object report;
    long first_report = 0;
  };
  // Takes steps, with a row of the log every `every` of them (0: as before), and with `to_end` one after the
  // last.
  void run(long steps, long every, const Calls& calls, bool to_end);
  Minimised minimise(double force, long steps, const py::object& progress);
  void measure_parts() { run_.simulation->measure_parts(); }
  py::bytes checkpoint(const std::string& history);
  void change(const std::vector<std::string>& overrides);  // settings of the run, as `taut resume --set`
  void close();  // releases the folder; no step is taken from here on
  void set_box(
      const Eigen::Matrix3d& vectors);  // a, b and c in columns [nm]; throws InputError for no such box

  const Simulation& engine() const { return *run_.simulation; }
  Simulation& settled();  // its forces are those of the positions, also after Python code has written there
  const std::shared_ptr<Shown>& shown() const { return shown_; }  // what the views of Python show
  std::vector<Record> rows() const { return log_.copy(); }        // so far, while it runs, too
  const std::shared_ptr<const std::vector<LogColumn>>& columns() const { return columns_; }  // of rows
  const std::string& summary() const {
    return summary_;
  }  // of the last run, as summary.json has it, or "null"
  const std::string& history() const { return run_.history; }  // that of the checkpoint it continues from
  std::string folder() const { return run_.folder ? run_.folder->path().string() : ""; }
  std::vector<std::string> notes() const;

 private:
  void expect_idle() const;           // throws while it runs
  void expect_this_process() const;   // throws after a fork
  void expect_between_steps() const;  // throws during a step; a callback is between two
  // Calls a function after a step, and starts again from what it wrote. Returns its result.
  py::object call(const py::object& function, const py::object& argument, long step);
  void set_steps(long steps, long every);
  void note_state();    // keeps a copy of positions and velocities, to notice when they are written to
  void undo_writing();  // restores that copy
  void expect_finite() const;
  void take_over_changes();  // starts again if Python code has written to the views
  // Minimises first if the goal asks for it. If it throws, the state is that before Python code wrote.
  void set_out_anew(const MinimiseGoal& goal = {}, const py::object& progress = py::none());
  [[noreturn]] void raise(const ExplainedFailure& failure) const;
  static pid_t this_process();

  OpenRun run_;
  bool begun_ = false, closed_ = false;
  SharedRows<Record> log_;
  std::shared_ptr<const std::vector<LogColumn>> columns_ =
      std::make_shared<const std::vector<LogColumn>>(log_columns(run_.simulation->scene()));
  std::string summary_ = "null";
  State seen_;                    // x and v as note_state() found them
  bool forces_outdated_ = false;  // a new box was undone
  std::shared_ptr<Shown> shown_ = std::make_shared<Shown>();
  std::atomic<bool> running_ = false, in_callback_ = false, setting_out_ = false;
  bool stopped_ = false;  // the callback returned False, or an exception was thrown
  pid_t made_in_ = this_process();
};

}  // namespace taut
