#pragma once

#include <atomic>
#include <vector>

#include "core.hpp"
#include "lent_state.hpp"
#include "simulation/recorded_run.hpp"
#include "simulation/resumption.hpp"

namespace taut {

// What a simulation goes on from, and how.
struct GoingOn {
  std::string bytes, folder;  // a checkpoint's, or the folder of a run with one, which it then goes on with
  std::vector<std::string> overrides;
  bool yes = false;  // outputs may be cut back, or begin anew
  std::optional<int> threads;
};

// A simulation as Python has one: with its folder, its log, and an eye on what is written to its views.
class PythonSimulation {
 public:
  PythonSimulation(Input input, const std::string& out, bool overwrite);
  PythonSimulation(const GoingOn& from, const py::list& forces);
  ~PythonSimulation() { leave_to_views(simulation_->state(), *shown_); }

  // `every`: steps from row to row, 0: as before. With `to_end` the last step has a row, too.
  void run(long steps, long every, const py::object& callback, bool to_end);
  void minimise(double force);
  py::bytes checkpoint();

  const Simulation& engine() const { return *simulation_; }
  Simulation& settled();                       // with forces where the atoms are
  const std::shared_ptr<Shown>& shown() const { return shown_; }  // the box as note_state found it
  const std::vector<Record>& rows() const { return log_; }
  std::string summary() const;  // as summary.json has it, or "null"
  std::string folder() const { return folder_ ? folder_->path().string() : ""; }
  std::vector<std::string> notes() const;

 private:
  void expect_idle() const;
  void expect_this_process() const;
  void expect_between_steps() const;  // idle, or in a callback
  void call(const py::object& callback, const Record& row);  // with what it wrote taken over
  void set_steps(long steps, long every);
  void note_state();
  void put_back();  // what was written since
  void expect_finite() const;
  void take_over_changes();         // somebody may have written to the views
  void set_out_anew(double force);  // where that fails, all is as it was before somebody wrote
  [[noreturn]] void raise(const ExplainedFailure& failure) const;
  static pid_t this_process();

  SceneSource source_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<RunFolder> folder_;
  bool begun_ = false;
  std::vector<Record> log_;
  std::optional<Summary> summary_;
  State seen_;  // x and v as they were left
  std::shared_ptr<Shown> shown_ = std::make_shared<Shown>();
  std::atomic<bool> running_ = false, in_callback_ = false, setting_out_ = false;
  bool stopped_ = false;  // by the callback
  pid_t made_in_ = this_process();
};

}  // namespace taut
