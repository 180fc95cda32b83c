#include "run_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/team.hpp"
#include "base/threads.hpp"
#include "base/usable_cores.hpp"
#include "base/words.hpp"
#include "printing.hpp"
#include "simulation/log_columns.hpp"
#include "systems/builders/motions.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/velocities.hpp"

namespace taut {
namespace {

// "300 K", or "300 K at 0 ps, 400 K at 100 ps" with straight lines between.
std::string bath_temperature(const RunSettings& run) {
  if (run.temperature_course.empty()) return fmt::format("{:g} K", run.temperature_k);
  std::vector<std::string> points;
  for (const auto& [t, kelvin] : run.temperature_course.points())
    points.push_back(fmt::format("{:g} K at {:g} ps", kelvin, t));
  return fmt::format("{}", fmt::join(points, ", "));
}

std::string thermostat_line(const RunSettings& run) {
  if (run.langevin())
    return fmt::format(", Langevin's thermostat at {}, friction {:g}/ps", bath_temperature(run),
                       run.friction_per_ps);
  if (run.rescaling())
    return fmt::format(", velocities rescaled to {} within {:g} ps", bath_temperature(run),
                       run.thermostat_ps);
  return "";
}

std::string barostat_line(const Scene& scene) {
  const RunSettings& run = scene.run;
  const char* by_clusters = scene.system.reach.empty() ? ""
                                                       : "; of what goes around the box each atom moves with "
                                                         "it, or each cluster of rigid bonds by its centre";
  if (run.barostat == "c-rescale")
    return fmt::format(", the box rescaled to {:g} bar within {:g} ps, {}{}", run.pressure_bar,
                       run.barostat_ps, run.coupling, by_clusters);
  if (run.barostat == "monte-carlo")
    return fmt::format(", the box by Monte Carlo at {:g} bar, every {} steps{}", run.pressure_bar,
                       run.barostat_every, by_clusters);
  return "";
}

// Says the precision and the number of threads, with the options that change them. Precision concerns forces
// between pairs alone. The forces of the start have shown how many threads have work.
std::string speed_line(const Simulation& simulation) {
  const Terms& terms = simulation.scene().terms;
  const bool mixed = terms.precision == Precision::kMixed;
  const int threads = simulation.threads(), cores = usable_cores();
  const ThreadScope of_the_run(threads);
  const int busy = std::min(threads, threads_in_team());
  const int other = busy < threads ? std::min(busy, cores) : threads < cores ? cores : 1;
  return fmt::format("{}{} of {}{}{}",
                     terms.nonbonded || terms.wca || terms.tabulated_pairs
                         ? fmt::format("{} precision (change with --precision {}), ",
                                       mixed ? "mixed" : "double", mixed ? "double" : "mixed")
                         : "",
                     counted(threads, "thread"), counted(cores, "core"),
                     busy < threads ? fmt::format(", of which so few atoms keep {} busy", busy) : "",
                     cores > 1 && other != threads ? fmt::format(" (change with --threads {})", other) : "");
}

// The error is left out where there are too few rows for one.
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
  say("\n{:.4g} µs a step, of which constraints take {:.3g} µs", s.us_per_step, s.constraint_us_per_step);
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
    say("  of which constraints {}, forces and integrator {:.2e}\n", drift(s.constraint_drift),
        s.drift.value - s.constraint_drift.value);
  if (s.heat) say("heat taken up {:.4g} kJ/mol\n", *s.heat);
}

// The columns of the log that a terminal shows.
std::vector<LogColumn> shown_columns(bool in_box) {
  std::vector<LogColumn> columns;
  for (const LogColumn& column : common_columns())
    if (column.terminal.heading && (in_box || !column.of_box)) columns.push_back(column);
  return columns;
}

}  // namespace

void print_title(const Scene& scene) {
  const std::string title = scene.name + (scene.hard_on.empty() ? "" : ": ") + scene.hard_on;
  say("{}\n", wrapped(title, terminal_width(), 0));
  for (const auto& note : scene.notes) say("  note: {}\n", wrapped(note, terminal_width(), 8));
}

// Which molecules have no whole, so that what files and measures say of their places and centres is of images.
std::string around_line(const Scene& scene) {
  const System& sys = scene.system;
  if (sys.reach.empty()) return "";
  const std::vector<int> molecule = molecules(sys, scene.terms);
  std::set<int> around;
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.reach[a] != Reach::kWhole) around.insert(molecule[a]);
  return fmt::format(", {} bonded around it to {} own image",
                     counted(static_cast<long>(around.size()), "molecule"),
                     around.size() == 1 ? "its" : "their");
}

std::string box_line(const Scene& scene, const Box& box) {
  const std::string tilt = box.tilt.isZero(0) ? ""
                                              : fmt::format(", tilted by {:.6g}, {:.6g}, {:.6g}",
                                                            box.tilt.x(), box.tilt.y(), box.tilt.z());
  return fmt::format("box {:.6g} × {:.6g} × {:.6g} nm{}{}", box.edge.x(), box.edge.y(), box.edge.z(), tilt,
                     around_line(scene));
}

std::string start_line(const Scene& scene) {
  const RunSettings& run = scene.run;
  return fmt::format("{} of {:g} fs = {:.6g} ps, seed {}, velocities {}{}{}", counted(run.steps, "step"),
                     run.dt_fs, static_cast<double>(run.steps) * run.h(), run.seed,
                     describe_velocities(scene), thermostat_line(run), barostat_line(scene));
}

void print_header(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const System& sys = scene.system;
  print_title(scene);
  const std::string sites =
      sys.sites.empty()
          ? ""
          : fmt::format(", of them {}", counted(static_cast<long>(sys.sites.size()), "virtual site"));
  const std::string one_sided =
      sys.one_sided.empty() ? "" : fmt::format(", besides {} one-sided", sys.one_sided.size());
  say("  atoms {}{}   bonds {}{}   clusters {}   degrees of freedom {}\n", sys.atoms(), sites,
      sys.bond_count(), one_sided, simulation.clusters(), simulation.dof().sum());
  const Box& box = simulation.state().box;
  if (box.periodic()) say("  {}\n", box_line(scene, box));
  say("  method {}: {}\n", scene.method.name(), simulation.method().setting());
  for (std::size_t m = 0; m < scene.motions.size(); ++m) say("  {}\n", in_words(scene.motions[m], m));
  say("  {}\n  {}\n\n", start_line(scene), speed_line(simulation));
  if (simulation.step() > 0) say("goes on from step {}\n", simulation.step());
  std::string headings, units;
  for (const LogColumn& column : shown_columns(box.periodic())) {
    const auto& [heading, width, format] = column.terminal;
    headings += fmt::format("{}{:>{}}", headings.empty() ? "" : " ", heading, width);
    units += fmt::format("{}{:>{}}", units.empty() ? "" : " ",
                         column.unit.empty() ? "" : fmt::format("[{}]", column.unit), width);
  }
  say("{}\n{}\n", headings, units);
}

void print_row(const Record& r) {
  std::string row;
  for (const LogColumn& column : shown_columns(r.pressure.has_value()))
    row += fmt::format(fmt::runtime(fmt::format("{}{{:>{}{}}}", row.empty() ? "" : " ", column.terminal.width,
                                                column.terminal.format)),
                       column.of(r));
  say("{}\n", row);
}

void print_summary(const Simulation& simulation, const Summary& s, bool stepped) {
  if (stepped)
    print_steps(simulation, s);
  else
    say("\nno step was taken\n");
  say("mean temperature {:.2f} K", s.temperature);
  print_temperatures(simulation.temperatures());
  if (s.pressure) say("pressure {} bar\n", with_error(*s.pressure, 1));
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    const Wall& wall = simulation.scene().terms.walls[w];
    say("wall {} at {} = {:g} nm: {} {}\n", w, "xyz"[wall.axis], wall.at, with_error(s.walls[w], 2),
        s.pressure ? "bar" : "kJ/mol/nm");
  }
  for (std::size_t b = 0; b < s.biases.size(); ++b) {
    const auto [value, force] = columns_of(simulation.scene().terms.biases[b], b);
    say("{} {} {}, force {} {}\n", value.words, with_error(s.biases[b].value, 4), value.unit,
        with_error(s.biases[b].force, 3), force.unit);
  }
  if (s.tension)
    say("{} {} kJ/mol/nm\n", columns_of_held(simulation.scene().run)[0].words, with_error(*s.tension, 3));
  if (s.steering_work) say("work of what moves springs and anchors {:.6g} kJ/mol\n", *s.steering_work);
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

void print_timings(const Timings& timings) {
  if (timings.parts.empty() || timings.steps == 0) return;
  const bool waits = timings.threads > 1;
  say("\n{} in {:.4g} s, {}\n", counted(timings.steps, "step"), timings.seconds(),
      counted(timings.threads, "thread"));
  say("  {:<16}{:>10}{:>12}{:>8}{}\n", "part", "calls", "ms a step", "%", waits ? "   waiting %" : "");
  for (const PartTime& part : timings.parts)
    say("  {:<16}{:>10}{:>12.4f}{:>8.1f}{}\n", name_of(part.part),
        part.part == StepPart::kRest ? "" : std::to_string(part.calls), timings.ms_a_step(part.seconds),
        timings.percent(part.seconds), waits ? fmt::format("{:>12.1f}", timings.waiting_percent(part)) : "");
  say("  {:<16}{:>10}{:>12.4f}{:>8.1f}\n", "all", "", timings.ms_a_step(timings.seconds()), 100.0);
}

}  // namespace taut
