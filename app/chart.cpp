#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"
#include "printing.hpp"
#include "studies/chart_study.hpp"
#include "studies/chart_verdict.hpp"
#include "study.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

struct ChartArguments : StudyArguments {
  std::optional<long> steps{}, drift_steps{};
  std::optional<int> repeats{};

  std::string command() const {
    return StudyArguments::command([&](CommandLine& line) {
      line.option("--repeats", repeats);
      line.option("--steps", steps);
      line.option("--drift-steps", drift_steps);
    });
  }
};

ChartPlan plan_of(const ChartArguments& arguments) {
  ChartPlan plan{.scene = arguments.read(), .methods = arguments.methods_or_all()};
  if (arguments.quick) plan.make_quick();
  plan.repeats = arguments.repeats.value_or(plan.repeats);
  plan.steps = arguments.steps.value_or(plan.steps);
  plan.drift_steps = arguments.drift_steps.value_or(plan.drift_steps);
  return plan;
}

// Notes for readers of the pictures.
std::vector<std::string> notes_of(const ChartPlan& plan) {
  std::vector<std::string> notes = plan.scene.notes;
  if (plan.quick)
    notes.push_back(fmt::format("quick, so rough: few settings, {} of {} steps, drift over {} steps",
                                counted(plan.repeats, "repeat"), plan.steps, plan.drift_steps));
  if (double load = 0; getloadavg(&load, 1) == 1)
    if (const std::string warning = warn_of_load(load, sysconf(_SC_NPROCESSORS_ONLN)); !warning.empty())
      notes.push_back(warning);
  if (plan.drift_steps < kStepsForInterval)
    notes.push_back(fmt::format("no intervals of the drift: they take {} steps, --drift-steps has {}",
                                kStepsForInterval, plan.drift_steps));
  if (!has_precisions(plan.scene)) notes.emplace_back("no panel of precisions: the scene has no pair forces");
  return notes;
}

// Throws InputError if none of the methods can hold these bonds, since the chart would be empty.
void refuse_unfit_methods(const ChartPlan& plan) {
  std::vector<std::string> reasons;
  for (const std::string& name : plan.methods) {
    try {
      const MethodOptions method = method_in_word(name);
      if (!plan.scene.system.one_sided.empty()) method.refuse_one_sided(plan.scene.system);
      make_method(plan.scene.system, method, plan.scene.run.h());
      return;
    } catch (const InputError& e) {
      reasons.emplace_back(e.what());
    }
  }
  throw InputError(fmt::format("{}: no method to chart: {}", plan.scene.name, fmt::join(reasons, "; ")));
}

// Prints one line per reason of failure, with all its settings.
void print_failures(const std::string& csv) {
  struct Alike {
    std::string first;
    long count = 0;
    std::vector<std::string> panels{};
  };
  const auto rows = csv_rows(csv);
  std::vector<std::string> reasons;
  std::map<std::string, Alike> of;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::string &panel = rows[k][0], &setting = rows[k][1], &reason = rows[k][3];
    const auto [at, fresh] = of.try_emplace(reason, Alike{setting});
    if (fresh) reasons.push_back(reason);
    Alike& alike = at->second;
    ++alike.count;
    if (std::ranges::find(alike.panels, panel) == alike.panels.end()) alike.panels.push_back(panel);
  }
  if (reasons.empty()) return;
  say("\n{} failed, not drawn (failures.csv has them all):\n", counted(std::ssize(rows) - 1, "setting"));
  for (const std::string& reason : reasons) {
    const Alike& alike = of[reason];
    say("  {}{} ({}): {}\n", alike.first, alike.count > 1 ? fmt::format(" and {} more", alike.count - 1) : "",
        fmt::join(alike.panels, ", "), reason);
  }
}

// Draws the panels of a finished study.
void show(const ChartPlan& plan, Study& study) {
  const Ledger& ledger = study.ledger();
  const std::string of = plan.scene.name + ": ", at = fmt::format("at {:g} fs", plan.scene.run.dt_fs);
  study.show(
      {"work", fmt::format("{}constraints {} (lower left is better)", of, at), work_csv(plan, ledger)},
      "Constraint time against bond error",
      fmt::format("A curve a method; its points are the values of the named setting. Bars: quartiles of "
                  "{} interleaved repeats of {} steps. Errors are of {} steps, after a quarter as many: "
                  "the largest is that of a step's worst bond, on average.",
                  plan.repeats, plan.steps, plan.drift_steps));
  std::vector<std::string> lines = chart_verdict(chart_points(plan, ledger), plan.scene.run.dt_fs);
  if (const auto unsettled = not_at_rest(plan, ledger); !unsettled.empty())
    lines.push_back(
        fmt::format("bond errors not at rest, so figures of this run alone (later half over earlier): {}",
                    fmt::join(unsettled, ", ")));
  say("\n");
  for (const std::string& line : lines) say("{}\n", wrapped(line, 100, 2));
  study.conclude(lines);
  study.show(
      {"drift",
       fmt::format("{}energy drift {} over {} steps (lower left is better)", of, at, plan.drift_steps),
       drift_csv(plan, ledger)},
      "Constraint time against energy drift",
      fmt::format("Slope of the total energy over {} steps; bars: 95 %, from the run's own standard "
                  "error. A bar to the border: zero is inside, and the drift at most that. The figures "
                  "have the bonds' share of it.",
                  plan.drift_steps));
  study.show({"order",
              fmt::format("{}distance from the exact trajectory after {:g} fs", of,
                          kOrderSteps * plan.scene.run.dt_fs),
              order_csv(plan, ledger)},
             "Trajectory error against step",
             "Distance from a run of newton (rattle where bonds are one-sided) at 1e-12 and a step of a "
             "quarter of the finest shown. The order is "
             "the slope; iterative methods are held to 1e-11.");
  study.show({"length", "cost against the length of freely jointed chains", length_csv(plan, ledger)},
             "Cost against chain length",
             "Freely jointed chains at 10 fs; iterative methods at tolerance 1e-8, the others at their "
             "defaults. No other scene's forces are in it.");
  if (has_precisions(plan.scene))
    study.show(
        {"precision",
         fmt::format("{}a whole step {}, double (full marks) and mixed precision (empty)", of, at),
         precision_csv(plan, ledger)},
        "What mixed precision costs and gains",
        "A whole step, every method at its defaults; pair geometry and force in single precision, sums in "
        "double.");
}

void chart(const ChartArguments& arguments) {
  const ChartPlan plan = plan_of(arguments);
  refuse_unfit_methods(plan);
  Study study(arguments, arguments.command(), {plan.scene});
  const Ledger& ledger = study.ledger();
  const std::vector<Job> jobs = chart_jobs(plan, ledger);
  say("{}: {}, step {:g} fs; {} of {}, {}\n", plan.scene.name,
      counted(plan.scene.system.bond_count(), "bond"), plan.scene.run.dt_fs,
      counted(std::ssize(plan.settings()), "setting"), counted(std::ssize(plan.methods), "method"),
      counted(std::ssize(jobs), "trial"));
  study.run(jobs, notes_of(plan));
  show(plan, study);
  const std::string failures = failures_csv(plan, ledger);
  study.show_table("failures.csv", failures,
                   {"What failed", "Settings that did not get through, and why.", {}, {}, {}});
  print_failures(failures);
  study.finish(plan.scene.name + ": speed against accuracy");
}

}  // namespace

void add_chart(Commands& commands) {
  auto arguments = std::make_shared<ChartArguments>(ChartArguments{{"chart"}});
  const Subcommand command = commands.add("chart", "chart each method's speed against its accuracy",
                                          [arguments] { chart(*arguments); });
  arguments->offer_first(command);
  command.option("--repeats", arguments->repeats, "of all that is timed (20)").positive();
  command.option("--steps", arguments->steps, "of a timed run (40)").positive();
  command
      .option("--drift-steps", arguments->drift_steps, "of a run whose energy and bonds are watched (4000)")
      .positive();
  arguments->offer_last(command, "rough: few points, few repeats");
}

}  // namespace taut
