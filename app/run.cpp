#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "md/aside_file.hpp"
#include "md/errors.hpp"
#include "progress.hpp"
#include "systems/openmm/openmm_import.hpp"
#include "systems/scene_file.hpp"
#include "systems/simulation.hpp"
#include "systems/start_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  std::string scene;
  std::vector<std::string> openmm;  // system.xml, state.xml
  std::optional<std::string> method;
  std::optional<long> steps;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;
  std::optional<fs::path> out;

  // --method, --steps and --dt-fs are short for keys; --set comes last and so prevails.
  std::vector<std::string> overrides() const {
    std::vector<std::string> all;
    if (method) all.push_back(fmt::format("method.name=\"{}\"", *method));
    if (steps) all.push_back(fmt::format("run.steps={}", *steps));
    if (dt_fs) all.push_back(fmt::format("run.dt_fs={}", *dt_fs));
    all.insert(all.end(), settings.begin(), settings.end());
    return all;
  }

  Scene read() const {
    if (scene.empty() == openmm.empty())
      throw InputError("taut run: expected a scene, or --openmm system.xml state.xml");
    if (openmm.empty()) return read_scene(find_scene(scene), overrides());
    Scene imported = import_openmm(openmm[0], openmm[1]);
    apply_overrides(imported, overrides());
    return imported;
  }
};

std::string thermostat_line(const RunSettings& run) {
  if (run.langevin())
    return fmt::format(", Langevin's thermostat at {:g} K, friction {:g}/ps", run.temperature_k,
                       run.friction_per_ps);
  if (run.rescaling())
    return fmt::format(", velocities rescaled to {:g} K within {:g} ps", run.temperature_k,
                       run.thermostat_ps);
  return "";
}

void print_header(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const System& sys = scene.system;
  fmt::print("{}: {}\n", scene.name, scene.hard_on);
  for (const auto& note : scene.notes) fmt::print("  note: {}\n", note);
  fmt::print("  atoms {}   bonds {}   clusters {}   degrees of freedom {}\n", sys.atoms(), sys.bond_count(),
             simulation.clusters(), simulation.dof().sum());
  if (sys.box.periodic())
    fmt::print("  box {:.6g} × {:.6g} × {:.6g} nm\n", sys.box.edge.x(), sys.box.edge.y(), sys.box.edge.z());
  fmt::print("  method {}: {}\n", method_name(scene.method), simulation.method_setting());
  fmt::print("  {} steps of {:g} fs = {:.6g} ps, seed {}{}\n\n", scene.run.steps, scene.run.dt_fs,
             static_cast<double>(scene.run.steps) * scene.run.h(), scene.run.seed,
             thermostat_line(scene.run));
  fmt::print("{:>9} {:>10} {:>13} {:>13} {:>8} {:>9} {:>6}\n", "step", "t [ps]", "E_pot [kJ]", "E_total [kJ]",
             "T [K]", "bond err", "iter");
}

void print_row(const Record& r) {
  fmt::print("{:>9} {:>10.4f} {:>13.6g} {:>13.8g} {:>8.2f} {:>9.1e} {:>6.3g}\n", r.step, r.t, r.potential,
             r.total(), r.temperature, r.bonds.max, r.iterations);
}

// OpenMM's StateDataReporter's columns, then ours.
constexpr std::string_view kLogHeader =
    "#\"Step\",\"Time (ps)\",\"Potential Energy (kJ/mole)\",\"Kinetic Energy (kJ/mole)\","
    "\"Total Energy (kJ/mole)\",\"Temperature (K)\",\"Speed (ns/day)\",\"Max Relative Bond Error\","
    "\"RMS Relative Bond Error\",\"Energy Drift (kJ/mole/ns/dof)\",\"Iterations per Step\"\n";

std::string log_row(const Record& r) {
  return fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.9g},{:.4g},{:.6e},{:.6e},{:.6e},{:.4g}\n", r.step,
                     r.t, r.potential, r.kinetic, r.total(), r.temperature, r.ns_per_day, r.bonds.max,
                     r.bonds.rms, r.drift, r.iterations);
}

std::string summary_json(const Simulation& simulation, const Summary& s) {
  const Scene& scene = simulation.scene();
  const nlohmann::ordered_json json = {
      {"scene", scene.name},
      {"method", method_name(scene.method)},
      {"atoms", scene.system.atoms()},
      {"bonds", scene.system.bond_count()},
      {"dof", simulation.dof().total()},
      {"steps", s.steps},
      {"dt_fs", scene.run.dt_fs},
      {"us_per_step", s.us_per_step},
      {"constraint_us_per_step", s.constraint_us_per_step},
      {"ns_per_day", s.ns_per_day},
      {"max_rel_bond_error", s.max_rel_bond_error},
      {"rms_rel_bond_error", s.rms_rel_bond_error},
      {"energy_drift_kj_mol_ns_dof", s.drift},
      {"energy_drift_standard_error", s.drift_error},
      {"temperature_k", s.temperature},
      {"potential_kj_mol", s.potential},
      {"total_kj_mol", s.total},
      {"converged", s.converged},
      {"method_setting", simulation.method_setting()},
      {"seed", scene.run.seed},
  };
  return json.dump(2) + "\n";
}

void print_summary(const Simulation& simulation, const Summary& s) {
  fmt::print("\n{:.4g} µs a step, of it constraints {:.3g} µs", s.us_per_step, s.constraint_us_per_step);
  if (const int bonds = simulation.scene().system.bond_count(); bonds > 0)
    fmt::print(" ({:.3g} ns a bond)", s.constraint_us_per_step * 1000 / bonds);
  fmt::print("; {:.4g} ns/day\n", s.ns_per_day);
  fmt::print("energy drift {:.2e} ± {:.1e} kJ/mol/ns/degree of freedom, mean temperature {:.2f} K\n", s.drift,
             s.drift_error, s.temperature);
  fmt::print("bond error (relative): largest {:.1e}, rms {:.1e}\n", s.max_rel_bond_error,
             s.rms_rel_bond_error);
  if (const int bonds = simulation.scene().system.bond_count(); bonds > 0) {
    const Eigen::VectorXd tension = simulation.bond_tensions();
    fmt::print("bond tension at the end: {:.4g} to {:.4g}, mean {:.4g} kJ/mol/nm\n", tension.minCoeff(),
               tension.maxCoeff(), tension.mean());
  }
}

void run(const RunArguments& arguments) {
  Simulation simulation(arguments.read());
  std::optional<AsideFile> log;
  if (arguments.out) {
    make_folder(*arguments.out);
    log.emplace(*arguments.out / "log.csv");
    log->write(kLogHeader);
  }
  print_header(simulation);
  Progress progress(simulation.scene().run.steps);
  Summary summary;
  try {
    summary = simulation.run(
        [&](const Record& r) {
          progress.clear();
          print_row(r);
          if (log) log->write(log_row(r));
        },
        [&](long step) { progress.at(step); });
  } catch (const SimulationFailure&) {
    progress.clear();
    if (log) log->commit();  // what was seen until then is kept
    throw;
  }
  progress.clear();
  print_summary(simulation, summary);
  if (!arguments.out) return;
  log->commit();
  AsideFile json(*arguments.out / "summary.json");
  json.write(summary_json(simulation, summary));
  json.commit();
  write_start(*arguments.out / "final.start.toml", simulation.scene().system, simulation.state());
  fmt::print("wrote {0}/log.csv, {0}/summary.json, {0}/final.start.toml\n", arguments.out->string());
}

}  // namespace

void add_run(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "run a scene, or a system prepared for OpenMM");
  command->add_option("scene", arguments->scene, "a scene's file, or its name as `taut scenes` lists it");
  command->add_option("--openmm", arguments->openmm, "OpenMM System and State, as XML")
      ->expected(2)
      ->type_name("SYSTEM.XML STATE.XML");
  command->add_option("--method", arguments->method, "constraint method (see `taut methods`)");
  command->add_option("--steps", arguments->steps, "number of steps");
  command->add_option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command
      ->add_option("--set", arguments->settings, "any key of the scene: run.seed=7, method.tolerance=1e-12")
      ->type_name("KEY=VALUE");
  command->add_option("--out", arguments->out, "folder for log.csv, summary.json and the final state");
  actions.emplace_back(command, [arguments] { run(*arguments); });
}

}  // namespace taut
