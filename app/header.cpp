#include "header.hpp"

#include <fmt/format.h>

#include <thread>

#include "base/threads.hpp"
#include "printing.hpp"
#include "systems/velocities.hpp"
#include "words.hpp"

namespace taut {
namespace {

std::string thermostat_line(const RunSettings& run) {
  if (run.langevin())
    return fmt::format(", Langevin's thermostat at {:g} K, friction {:g}/ps", run.temperature_k,
                       run.friction_per_ps);
  if (run.rescaling())
    return fmt::format(", velocities rescaled to {:g} K within {:g} ps", run.temperature_k,
                       run.thermostat_ps);
  return "";
}

std::string barostat_line(const RunSettings& run) {
  if (run.barostat == "c-rescale")
    return fmt::format(", the box rescaled to {:g} bar within {:g} ps, {}", run.pressure_bar, run.barostat_ps,
                       run.coupling);
  if (run.barostat == "monte-carlo")
    return fmt::format(", the box by Monte Carlo at {:g} bar, every {} steps", run.pressure_bar,
                       run.barostat_every);
  return "";
}

// One thread computes unless told otherwise, which nobody should have to find out.
std::string threads_line(int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return fmt::format("{} of {}{}", threads, counted(cores, "core"),
                     threads < cores ? fmt::format(", --threads {} for more", cores) : "");
}

}  // namespace

void print_title(const Scene& scene) {
  const std::string title = scene.name + (scene.hard_on.empty() ? "" : ": ") + scene.hard_on;
  say("{}\n", wrapped(title, terminal_width(), 0));
  for (const auto& note : scene.notes) say("  note: {}\n", wrapped(note, terminal_width(), 8));
}

std::string box_line(const Box& box) {
  const std::string tilt = box.tilt.isZero(0) ? ""
                                              : fmt::format(", tilted by {:.6g}, {:.6g}, {:.6g}",
                                                            box.tilt.x(), box.tilt.y(), box.tilt.z());
  return fmt::format("box {:.6g} × {:.6g} × {:.6g} nm{}", box.edge.x(), box.edge.y(), box.edge.z(), tilt);
}

std::string start_line(const Scene& scene) {
  const RunSettings& run = scene.run;
  return fmt::format("{} of {:g} fs = {:.6g} ps, seed {}, velocities {}{}{}", counted(run.steps, "step"),
                     run.dt_fs, static_cast<double>(run.steps) * run.h(), run.seed,
                     describe_velocities(scene), thermostat_line(run), barostat_line(run));
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
  if (box.periodic()) say("  {}\n", box_line(box));
  say("  method {}: {}\n", scene.method.name(), simulation.method().setting());
  say("  {}\n  threads {}\n\n", start_line(scene), threads_line(simulation.threads()));
  if (simulation.step() > 0) say("goes on from step {}\n", simulation.step());
  const bool pressed = box.periodic();
  say("{:>8} {:>10} {:>12} {:>12} {:>8} {:>9} {:>5}{}\n", "step", "t", "E_pot", "E_total", "T", "bond err",
      "iter", pressed ? "        P" : "");
  say("{:>8} {:>10} {:>12} {:>12} {:>8} {:>9} {:>5}{}\n", "", "[ps]", "[kJ/mol]", "[kJ/mol]", "[K]", "", "",
      pressed ? "    [bar]" : "");
}

void print_row(const Record& r) {
  say("{:>8} {:>10.4f} {:>12.6g} {:>12.8g} {:>8.2f} {:>9.1e} {:>5.3g}{}\n", r.step, r.t, r.potential,
      r.total(), r.temperature, r.bonds.max, r.iterations,
      r.pressure ? fmt::format(" {:>8.1f}", *r.pressure) : "");
}

}  // namespace taut
