#include "studies/crosscheck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "measures/csv.hpp"
#include "pictures.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "scene_argument.hpp"
#include "studies/bond_lengths.hpp"
#include "studies/crosscheck_tables.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "studies/openmm_twin.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "systems/lammps/write_data.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

std::string or_dash(double value, bool known) {
  return known ? fmt::format("{:.1e}", value) : "–";
}

constexpr int kWidth = 80;

// Of the column of names.
std::size_t names_width(const Crosscheck& c) {
  std::size_t width = 24;
  for (const Track* track : all_tracks(c)) width = std::max(width, track->name.size());
  return width;
}

void print_positions(const Crosscheck& c) {
  constexpr auto kRow = "{:<{}} {:>9} {:>8} {:>9} {:>10} {:>9}\n";
  const std::size_t width = names_width(c);
  say(kRow, "", width, "apart", "parted", "off fine", "bond error", "");
  say(kRow, "", width, "[nm]", "at step", "run [nm]", "max", "rms");
  for (const Track* track : all_tracks(c)) {
    const bool ran = track->samples.size() > 1, bonded = ran && c.bonds > 0;
    const auto parted = track->parted_at(c.agreement);
    const double apart = track->apart_at(c.parting);
    say(kRow, track->name, width, or_dash(apart, ran && apart >= 0),
        parted ? fmt::format("{}", *parted) : "–",
        or_dash(last_from_truth(*track), last_from_truth(*track) >= 0), or_dash(track->worst_bond(), bonded),
        or_dash(track->rms_bond(c.steps), bonded));
  }
}

void print_energies(const Crosscheck& c) {
  constexpr auto kRow = "{:<{}} {:>18} {:>14} {:>10}\n";
  const std::size_t width = names_width(c);
  say(kRow, "", width, "energy drift", "bonds' share", "T");
  say(kRow, "", width, "[kJ/mol/ns/dof]", "", "[K]");
  for (const Track* track : all_tracks(c)) {
    const auto& share = track->constraint_drift;
    const Estimate& drift = track->drift;
    say(kRow, track->name, width,
        drift.error > 0 ? fmt::format("{:.1e} ± {:.0e}", drift.value, drift.error) : "–",
        or_dash(share ? share->value : 0, share.has_value()),
        track->samples.size() > 1 ? fmt::format("{:.2f}", track->temperature.value) : "–");
  }
}

void print_bond_lengths(const Crosscheck& c) {
  const std::vector<BondLengths> all = bond_lengths(c);
  if (all.empty()) return;
  constexpr auto kRow = "{:<{}} {:>8} {:>9} {:>19} {:>9}  {}\n";
  std::size_t width = 24;
  for (const BondLengths& of : all) width = std::max(width, of.run.size());
  say("\n");
  say(kRow, "bond lengths", width, "error", "", "its slope", "in 1 ns", "made of");
  say(kRow, "", width, "rms", "largest", "[1/ns]", "at most", "");
  for (const BondLengths& of : all)
    say(kRow, of.run, width, fmt::format("{:.1e}", of.rms.value), fmt::format("{:.1e}", of.largest),
        of.slope.error > 0 ? fmt::format("{:.1e} ± {:.0e}", of.slope.value, of.slope.error) : "–",
        of.slope.error > 0 ? fmt::format("{:.0e}", of.in_a_ns) : "–", of.made_of);
}

std::string verdicts_csv(const Crosscheck& c) {
  std::string text = "run,finding,why\n";
  for (const Verdict& v : verdicts(c))
    text += fmt::format("{},{},{}\n", csv_cell(v.who), name_of(v.finding), csv_cell(v.why));
  return text;
}

std::string platform_of(const Crosscheck& c) {
  return c.platform + (c.precision.empty() ? "" : ", " + c.precision) +
         (c.plugged.empty() ? "" : ", TautIntegrator");
}

void print_crosscheck(const Crosscheck& c) {
  const auto say_wrapped = [](const std::string& text) { say("{}\n", wrapped(text, kWidth, 2)); };
  say_wrapped(fmt::format("{} against OpenMM {} ({}): {}, {}, {} of {:g} fs", c.scene, c.openmm,
                          platform_of(c), counted(c.atoms, "atom"), counted(c.bonds, "bond"),
                          counted(c.steps, "step"), c.h * 1000));
  say_wrapped(headline(c));
  say("\n");
  for (const auto& note : c.notes) say_wrapped("note: " + note);
  say_wrapped(fmt::format(
      "at the start: energy {:.10g} kJ/mol, OpenMM {:.10g}; forces {:.4g} kJ/mol/nm rms, apart by {:.1e}",
      c.start.energy, c.start.openmm_energy, c.start.force_rms, c.start.force_difference));
  if (!c.twin.failed() && !c.nudged.failed())
    say_wrapped(fmt::format("chaos: two {} runs 1e-10 nm apart are {:.1e} nm apart after {} steps, {}",
                            c.plugged.empty() ? "OpenMM" : "taut", 1e-10 * c.chaos.growth, c.chaos.steps,
                            c.chaos.growth > 100 ? fmt::format("growing by {:.2g} ± {:.1g} /ps",
                                                               c.chaos.rate.value, c.chaos.rate.error)
                                                 : "too little for a rate"));
  say("\n");
  print_positions(c);
  say("\n");
  print_energies(c);
  print_bond_lengths(c);
  say("\nwhy\n");
  for (const Verdict& v : verdicts(c))
    say("{:<24} {:<7} {}\n", v.who, name_of(v.finding), wrapped(v.why, kWidth, 33));
  if (!c.long_enough) {
    say("\n");
    say_wrapped(
        "Too short for averages: temperatures, g(r) and end-to-end distances are held together from 5 ps "
        "on.");
  }
  if (c.speed.empty()) return;
  say("\nwhole step, equal threads\n");
  for (const auto& [who, us, failure] : c.speed)
    say("  {:<46} {}\n", who,
        failure.empty() ? fmt::format("{:>9.1f} µs", us) : wrapped("failed: " + failure, kWidth, 49));
}

// Writes crosscheck.json (all figures and verdicts), crosscheck.csv (every sample of every run),
// distances.csv for liquid water, the pictures and report.html. `command` is the command line.
StudyFiles write_crosscheck(const Crosscheck& c, const std::string& command,
                            const std::filesystem::path& folder, const PictureOptions& options) {
  StudyFiles files(folder, options);
  files.write("crosscheck.json", crosscheck_json(c) + "\n");
  const std::string title = fmt::format("{}: taut against OpenMM {}, {}", c.scene, c.openmm, platform_of(c));
  ReportPage page{title, command, c.notes, {}};
  const auto show = [&](const Picture& picture, const char* heading, const char* text) {
    files.draw(picture);
    page.parts.push_back({heading, text, "", picture.csv, {}});
  };
  show({"crosscheck", title, samples_csv(c)}, "Runs beside OpenMM's",
       c.plugged.empty()
           ? "Every run sets out from OpenMM's start. The fine run takes an eighth of the step: what is as "
             "near to it as OpenMM's own run is as right."
           : "Every method runs in taut, and in OpenMM by the plug-in: round-off alone sets the two apart.");
  if (!c.twin.oxygens.r.empty())
    show({"distances", c.scene + ": O–O radial distribution, bands: standard errors", distances_csv(c)},
         "What the liquid looks like", "The radial distribution of the oxygens.");
  page.parts.front().conclusions = {headline(c)};
  page.parts.push_back(
      {"Verdicts", "Of each run: whether it agrees with OpenMM's, and why.", {}, verdicts_csv(c), {}});
  write_report(page, files);
  return files;
}

struct CrosscheckArguments {
  SceneArgument scene;
  std::vector<std::string> methods;
  std::optional<std::filesystem::path> out;
  PictureOptions pictures;
  bool overwrite = false;
  std::optional<std::string> prefix;  // prefix of the exported files
  std::optional<std::string> lammps;  // the same for LAMMPS
  CrosscheckPlan plan;

  std::string command() const {
    CommandLine line = scene.line("crosscheck");
    line.option("--methods", methods);
    line.option("--steps", scene.steps);
    line.option("--dt-fs", scene.dt_fs);
    line.option("--set", scene.settings);
    const CrosscheckPlan usual;
    const auto unless = [&](const char* name, const auto& value, const auto& otherwise) {
      if (value != otherwise) line.option(name, std::optional(value));
    };
    unless("--platform", plan.platform, usual.platform);
    unless("--precision", plan.precision, usual.precision);
    unless("--integrator", plan.integrator, usual.integrator);
    unless("--agreement-nm", plan.agreement, usual.agreement);
    unless("--parting-steps", plan.parting_steps, usual.parting_steps);
    unless("--speed-seconds", plan.speed_seconds, usual.speed_seconds);
    unless("--threads", plan.threads, usual.threads);
    return line.text();
  }
};

void crosscheck_scene(CrosscheckArguments arguments) {
  refuse_without_effect("crosscheck", arguments.scene.settings);
  const Scene scene = arguments.scene.read(nullptr, {"run.steps=200"});
  if (arguments.lammps) {
    expect_no_file({*arguments.lammps + ".data", *arguments.lammps + ".in"}, arguments.overwrite);
    write_lammps(scene, *arguments.lammps);
    say("wrote {0}.data, {0}.in\n", *arguments.lammps);
    if (!arguments.prefix) return;
  }
  if (arguments.prefix) {
    expect_no_file({*arguments.prefix + ".system.xml", *arguments.prefix + ".state.xml"},
                   arguments.overwrite);
    write_openmm(openmm_input(scene), *arguments.prefix);
    say("wrote {0}.system.xml, {0}.state.xml\n", *arguments.prefix);
    if (!built_with_openmm()) return say("held against nothing: taut was built without OpenMM\n");
  }
  CrosscheckPlan& plan = arguments.plan;
  plan.contestants =
      contestants(arguments.methods.empty() ? plan.usual_methods() : arguments.methods, plan.plugged());
  if (const auto& files = arguments.scene.openmm; !files.empty())
    plan.files = OpenMMFiles{files[0], files[1]};
  Progress progress;
  progress.write_rows("tasks");
  std::optional<FolderLock> lock;
  const Crosscheck result = crosscheck(scene, plan, [&](const std::string& what) {
    if (arguments.out && !lock) lock.emplace(study_folder(*arguments.out, "", arguments.overwrite));
    progress.show_task(what);
  });
  progress.clear();
  const auto print = [&] {
    print_crosscheck(result);
    if (json_alone()) write_out(crosscheck_json(result) + "\n");
  };
  std::optional<StudyFiles> files;
  try {
    if (arguments.out)
      files = write_crosscheck(result, arguments.command(), *arguments.out, arguments.pictures);
  } catch (const OutsideError&) {  // a full disk takes nothing from the screen
    print();
    throw;
  }
  print();
  if (files) files->print_written();
  if (std::ranges::any_of(verdicts(result), [](const Verdict& v) { return v.finding == Finding::kFailed; }))
    throw SimulationFailure(headline(result));
}

}  // namespace

void add_crosscheck(Commands& commands) {
  auto arguments = std::make_shared<CrosscheckArguments>();
  CrosscheckPlan& plan = arguments->plan;
  const Subcommand command = commands.add("crosscheck", "hold a scene's runs against OpenMM's",
                                          [arguments] { crosscheck_scene(*arguments); });
  arguments->scene.NamedScene::offer(command);
  command
      .option("--methods", arguments->methods,
              "to hold against OpenMM, with settings as in rattle:sweeps=4 (the usual ones)")
      .words(0, "METHOD");
  command.option("--steps", arguments->scene.steps, "number of steps (200)").positive();
  arguments->scene.offer_settings(command);
  command.option("--platform", plan.platform,
                 "OpenMM's: Reference (double precision), CPU, OpenCL, CUDA or HIP");
  command
      .option("--precision", plan.precision, "of OpenMM's platform, if a device's: single, mixed or double")
      .words(0, "WORD");
  command
      .option("--integrator", plan.integrator,
              "in OpenMM: openmm for its own, taut for that of taut's plug-in, beside taut's own runs")
      .words(0, "WORD");
  command.option("--agreement-nm", plan.agreement, "apart by more than this, runs have parted");
  command.option("--parting-steps", plan.parting_steps, "where runs that only explain end");
  command.option("--speed-seconds", plan.speed_seconds, "for each figure of speed; 0: none");
  command.option("--threads", plan.threads, "of taut and of OpenMM's CPU platform").positive();
  command.option("--out", arguments->out, "folder for crosscheck.json, crosscheck.csv and the pictures");
  arguments->pictures.offer(command);
  command.flag("--overwrite", arguments->overwrite,
               "move the study that is in --out to OUT.1, OUT.2, ...; replace what --export writes");
  command.option("--export", arguments->prefix, "write PREFIX.system.xml and PREFIX.state.xml for OpenMM")
      .words(0, "PREFIX");
  command
      .option("--export-lammps", arguments->lammps, "write PREFIX.data and PREFIX.in for LAMMPS, and no more")
      .words(0, "PREFIX");
  command.json("print all figures and verdicts, as JSON");
}

}  // namespace taut
