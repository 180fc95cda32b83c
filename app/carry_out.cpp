#include "carry_out.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "header.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "simulation/recorded_run.hpp"
#include "stop_request.hpp"

namespace taut {
namespace {

std::vector<std::string> written(const RunFolder& folder) {
  std::vector<std::string> files = run_files(folder.path());
  for (std::string& file : files) file = (folder.path() / file).string();
  return files;
}

// A few rows are too few for an error.
std::string with_error(const Estimate& e, int digits) {
  return fmt::format("{:.{}f}", e.value, digits) +
         (e.error > 0 ? fmt::format(" ± {:.{}f}", e.error, digits) : "");
}

// One line a type of molecule, where there is more to say than the temperature of all.
void print_temperatures(const Temperatures& temperatures) {
  for (std::size_t type = 0; type < temperatures.types().size(); ++type) {
    std::string line;
    for (int motion = 0; motion < 3; ++motion) {
      if (temperatures.types()[type].dof[motion] < 0.5) continue;
      const Estimate t = temperatures.temperature(static_cast<int>(type), MotionClass(motion));
      line += fmt::format("{} {} {} K", line.empty() ? "" : ",", kMotionNames[motion], with_error(t, 2));
    }
    if (!line.empty()) say("; {}:{}", temperatures.types()[type].name, line);
  }
  say("\n");
}

// What steps cost, and what they did to the energy.
void print_steps(const Simulation& simulation, const Summary& s) {
  const int bonds = simulation.scene().system.bond_count();
  say("\n{:.4g} µs a step, of it constraints {:.3g} µs", s.us_per_step, s.constraint_us_per_step);
  const double each = bonds > 0 ? s.constraint_us_per_step * 1000 / bonds : 0;
  if (bonds > 0) say(" ({:.{}f} ns a bond)", each, each < 100 ? 1 : 0);
  say("; {:.4g} ns/day\n", s.ns_per_day);
  const auto drift = [](const Estimate& e) {
    return fmt::format("{:.2e}", e.value) + (e.error > 0 ? fmt::format(" ± {:.1e}", e.error) : "");
  };
  const bool metered = !simulation.scene().run.barostatted();
  if (metered)
    say("energy drift{} {} kJ/mol/ns/degree of freedom\n", s.heat ? ", but for the heat," : "",
        drift(s.drift));
  else
    say("energy drift by bonds {} kJ/mol/ns/degree of freedom; the box's work is not metered\n",
        drift(s.constraint_drift));
  if (metered && bonds > 0)
    say("  of it the bonds' {}, the forces' {:.2e}\n", drift(s.constraint_drift),
        s.drift.value - s.constraint_drift.value);
  if (s.heat) say("heat taken up {:.4g} kJ/mol\n", *s.heat);
}

void print_summary(const Simulation& simulation, const Summary& s, bool stepped) {
  if (stepped)
    print_steps(simulation, s);
  else
    say("\nno step was taken\n");
  say("mean temperature {:.2f} K", s.temperature);
  print_temperatures(simulation.temperatures());
  if (s.pressure) say("pressure {} bar\n", with_error(*s.pressure, 1));
  if (simulation.scene().run.barostatted())
    say("density {} kg/m³, volume {} nm³\n", with_error(s.density, 2), with_error(s.volume, 4));
  if (simulation.scene().system.bond_count() > 0) {
    say("bond error (relative): largest {:.1e}, rms {:.1e}\n", s.max_rel_bond_error, s.rms_rel_bond_error);
    const Eigen::VectorXd tension = simulation.bond_tensions();
    say("bond tension at the end: {:.4g} to {:.4g}, mean {:.4g} kJ/mol/nm\n", tension.minCoeff(),
        tension.maxCoeff(), tension.mean());
  }
  if (const System& sys = simulation.scene().system; !sys.one_sided.empty()) {
    const auto lambda = simulation.method().lambda().tail(std::ssize(sys.one_sided));
    double strongest = 0;
    for (int k = 0; k < lambda.size(); ++k)
      strongest = std::max(strongest, std::abs(lambda[k]) * sys.one_sided[k].length);
    say("one-sided bonds at the end: {} of {} act, the strongest with {:.4g} kJ/mol/nm\n",
        (lambda.array() != 0).count(), lambda.size(), strongest);
  }
}

void print_doubts(const Summary& s) {
  if (json_alone()) return;  // which has them
  for (const auto& doubt : s.doubts) say_always(fmt::format("in doubt: {}\n", doubt));
}

std::string to_go_on(const RunFolder& folder, long step) {
  return fmt::format("`taut resume {}` goes on from step {}", quoted_for_shell(folder.path().string()), step);
}

const char* name_of(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGHUP:
      return "SIGHUP";
    case SIGPIPE:
      return "SIGPIPE";
    default:
      return "SIGTERM";
  }
}

std::string how_to_go_on(const Simulation& simulation, const RunFolder* folder, int signal) {
  return fmt::format(
      "stopped at step {} of {} by {}; {}\n", simulation.step(), simulation.scene().run.steps,
      name_of(signal),
      folder ? to_go_on(*folder, simulation.step()) : "nothing was kept: a run with --out can be resumed");
}

// What a run says while it goes on. A run that keeps its data in a folder goes on where its output is not
// taken, and ends with an error; where its reader has closed the pipe, it stops as by a signal.
class Told {
 public:
  Told(const StopRequest& request, const RunFolder* folder) : request_(request), folder_(folder) {}

  void tell(const auto& print) {
    if (!folder_ && !request_.signal()) return print();
    try {
      print();
    } catch (const Stopped&) {
      request_.pipe_is_closed();
    } catch (const OutsideError& e) {
      refused_ = e;
    }
  }
  void expect_taken() const {
    if (refused_) throw OutsideError(*refused_);
  }

 private:
  const StopRequest& request_;
  const RunFolder* folder_;
  std::optional<OutsideError> refused_;
};

// What is known of the failure, what of it is kept, and how to go on.
[[noreturn]] void explain(const ExplainedFailure& failure, const RunFolder* folder) {
  if (!failure.unwritten.empty()) complain(failure.unwritten);
  std::string kept;
  if (folder && failure.unwritten.empty())
    kept = fmt::format("\n  kept: {0}/last_good.start.toml, the state one step before, and {0}/failure.json",
                       folder->path().string());
  if (folder && folder->kept_step()) kept += fmt::format("\n  {}", to_go_on(*folder, *folder->kept_step()));
  throw SimulationFailure(failure.what() + kept);
}

}  // namespace

void carry_out(Simulation& simulation, RunFolder* folder, Measured* measured) {
  const StopRequest request;
  Told told(request, folder);
  const long first = simulation.step(), steps = simulation.scene().run.steps;
  Progress progress(steps - first);
  const auto on_record = [&](const Record& r) {
    progress.clear();
    if (measured && r.step % simulation.scene().run.log_every == 0)
      measured->see(simulation.state().x, simulation.state().box);
    told.tell([&] { print_row(r); });
  };
  const auto go_on = [&](long step) {
    progress.at(step - first);
    return request.signal() == 0;
  };
  Summary summary;
  try {
    if (folder) folder->begin(simulation);
    told.tell([&] {
      if (folder && !folder->note().empty()) say("{}\n", folder->note());
      print_header(simulation);
    });
    summary = take_steps(simulation, folder, {on_record, go_on});
    progress.clear();
  } catch (const ExplainedFailure& failure) {
    progress.clear();
    explain(failure, folder);
  } catch (const OutsideError& e) {
    progress.clear();
    if (!folder || !folder->kept_step()) throw;
    throw OutsideError(fmt::format("{}; that mended, {}", e.what(), to_go_on(*folder, *folder->kept_step())));
  }
  if (simulation.step() < steps) {
    const int signal = request.signal();
    told.tell([&] {
      say("\n");
      say_always(how_to_go_on(simulation, folder, signal));
    });
    throw Stopped{128 + signal};
  }
  if (json_alone()) {
    auto all = summary_json(simulation, summary);
    if (measured) all["measured"] = measured->json();
    write_out(all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  print_summary(simulation, summary, simulation.step() > first);
  if (measured) measured->print();
  print_doubts(summary);
  if (folder) say("wrote {}\n", fmt::join(written(*folder), ", "));
  told.expect_taken();
}

}  // namespace taut
