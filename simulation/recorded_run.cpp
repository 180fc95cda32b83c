#include "simulation/recorded_run.hpp"

#include <algorithm>
#include <chrono>

namespace taut {
namespace {

// When checkpoints are due: every so many steps, and by the clock, at first as soon as the run has gone on
// for as long again. So a kill takes half of a short run at most, and checkpoint_minutes of a long one.
class CheckpointSchedule {
 public:
  explicit CheckpointSchedule(const RunSettings& run)
      : every_(run.checkpoint_every), interval_(60 * run.checkpoint_minutes) {}

  bool due(long step) const {
    if (every_ > 0 && step % every_ == 0) return true;
    const Seconds whole = last_ - start_, since = Clock::now() - last_;
    return interval_.count() > 0 && since >= std::min(interval_, std::max(whole, Seconds(1)));
  }
  void taken() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  long every_;
  Seconds interval_;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

[[noreturn]] void explain(Simulation& simulation, RunFolder* folder, const SimulationFailure& failure) {
  std::optional<Diagnosis> diagnosis = simulation.diagnose();
  if (!diagnosis) throw failure;
  ExplainedFailure explained(std::move(*diagnosis));
  try {
    if (folder) folder->write_failure(simulation, explained.diagnosis);
  } catch (const OutsideError& e) {
    explained.unwritten = e.what();
  }
  throw explained;
}

}  // namespace

Summary take_steps(Simulation& simulation, RunFolder* folder, const RunWatch& watch) {
  const RunSettings& settings = simulation.scene().run;
  CheckpointSchedule schedule(settings);
  const auto on_record = [&](const Record& r) {
    if (folder) folder->add_row(r);
    if (watch.on_record) watch.on_record(r);
  };
  const auto on_step = [&](long step) {
    if (folder) folder->add_frame(simulation);
    const bool stop = watch.go_on && !watch.go_on(step);
    if (folder && (stop || step == settings.steps || schedule.due(step))) {
      folder->keep(simulation);
      schedule.taken();
    }
    if (stop) simulation.stop();
  };
  try {
    const Summary summary = simulation.run(on_record, on_step);
    if (folder && simulation.step() >= settings.steps) folder->write_end(simulation, summary);
    return summary;
  } catch (const SimulationFailure& failure) {
    explain(simulation, folder, failure);
  } catch (const OutsideError&) {
    throw;
  } catch (...) {  // by foreign code, whose step was taken back: the run stops here
    if (folder && simulation.runs_foreign_code()) folder->keep(simulation);
    throw;
  }
}

}  // namespace taut
