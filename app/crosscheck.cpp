#include "studies/crosscheck.hpp"

#include <fmt/format.h>

#include <memory>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "crosscheck_report.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "scene_argument.hpp"
#include "studies/crosscheck_tables.hpp"
#include "studies/openmm_twin.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

struct CrosscheckArguments {
  SceneArgument scene;
  std::vector<std::string> methods;
  std::optional<std::filesystem::path> out;
  bool overwrite = false;
  std::optional<std::string> prefix;  // of the exported files
  CrosscheckPlan plan;

  std::string command() const {
    CommandLine line = scene.line("crosscheck");
    line.option("--method", methods);
    line.option("--steps", scene.steps);
    line.option("--dt-fs", scene.dt_fs);
    line.option("--set", scene.settings);
    const CrosscheckPlan usual;
    const auto unless = [&](const char* name, const auto& value, const auto& otherwise) {
      if (value != otherwise) line.option(name, std::optional(value));
    };
    unless("--platform", plan.platform, usual.platform);
    unless("--agreement-nm", plan.agreement, usual.agreement);
    unless("--parting-steps", plan.parting_steps, usual.parting_steps);
    unless("--speed-seconds", plan.speed_seconds, usual.speed_seconds);
    unless("--threads", plan.threads, usual.threads);
    return line.text();
  }
};

void run(CrosscheckArguments arguments) {
  refuse_without_effect("crosscheck", arguments.scene.settings);
  const Scene scene = arguments.scene.read(nullptr, {"run.steps=200"});
  if (arguments.prefix) {
    expect_no_file({*arguments.prefix + ".system.xml", *arguments.prefix + ".state.xml"},
                   arguments.overwrite);
    write_openmm(openmm_input(scene), *arguments.prefix);
    say("wrote {0}.system.xml, {0}.state.xml\n", *arguments.prefix);
    if (!built_with_openmm()) return say("held against nothing: taut was built without OpenMM\n");
  }
  arguments.plan.contestants = contestants(arguments.methods);
  if (const auto& files = arguments.scene.openmm; !files.empty())
    arguments.plan.files = OpenMMFiles{files[0], files[1]};
  Progress progress;
  std::optional<FolderLock> lock;
  const Crosscheck result = crosscheck(scene, arguments.plan, [&](const std::string& what) {
    if (arguments.out && !lock) lock.emplace(study_folder(*arguments.out, "", arguments.overwrite));
    progress.show_task(what);
  });
  progress.clear();
  print_crosscheck(result);
  if (arguments.out) write_crosscheck(result, arguments.command(), *arguments.out);
  if (json_alone()) write_out(crosscheck_json(result) + "\n");
}

}  // namespace

void add_crosscheck(Commands& commands) {
  auto arguments = std::make_shared<CrosscheckArguments>();
  CrosscheckPlan& plan = arguments->plan;
  const Subcommand command =
      commands.add("crosscheck", "hold a scene's runs against OpenMM's", [arguments] { run(*arguments); });
  arguments->scene.NamedScene::offer(command);
  command
      .option("--method", arguments->methods,
              "to hold against OpenMM: a name, baumgarte:GAINS; several; the usual ones if none is given")
      .words(0, "METHOD");
  command.option("--steps", arguments->scene.steps, "number of steps (200)").positive();
  arguments->scene.offer_settings(command);
  command.option("--platform", plan.platform, "OpenMM's: Reference (double precision) or CPU");
  command.option("--agreement-nm", plan.agreement, "apart by more than this, runs have parted");
  command.option("--parting-steps", plan.parting_steps, "where runs that only explain end");
  command.option("--speed-seconds", plan.speed_seconds, "for each figure of speed; 0: none");
  command.option("--threads", plan.threads, "of taut and of OpenMM's CPU platform").positive();
  command.option("--out", arguments->out, "folder for crosscheck.json, crosscheck.csv and the pictures");
  command.flag("--overwrite", arguments->overwrite,
               "move the study that is in --out to OUT.1, OUT.2, ...; replace what --export writes");
  command.option("--export", arguments->prefix, "write PREFIX.system.xml and PREFIX.state.xml for OpenMM")
      .words(0, "PREFIX");
  command.json("print all figures and verdicts, as JSON");
}

}  // namespace taut
