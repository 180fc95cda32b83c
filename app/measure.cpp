#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "commands.hpp"
#include "files/dcd_file.hpp"
#include "files/folder.hpp"
#include "measured.hpp"
#include "printing.hpp"
#include "simulation/checkpoint.hpp"
#include "study.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct MeasureArguments {
  fs::path folder;
  std::vector<std::string> atoms;  // names of the two atoms of the radial distribution
  std::optional<fs::path> out;
  bool overwrite = false;
};

fs::path trajectory_of(const fs::path& folder) {
  fs::path file = folder / "trajectory.dcd";
  if (fs::exists(file)) return file;
  const bool other = fs::exists(folder / "trajectory.h5md");
  throw InputError(fmt::format(
      "{}: no such file; {}", file.string(),
      other ? "run with run.trajectory = \"dcd\" or \"both\"" : "run with --set run.trajectory_every=100"));
}

void measure_folder(const MeasureArguments& arguments) {
  expect_checkpoint(arguments.folder);
  if (arguments.out)
    expect_no_file({*arguments.out / "distances.csv", *arguments.out / "displacement.csv"},
                   arguments.overwrite);
  const Scene scene = load_checkpoint(arguments.folder).source.read();
  const fs::path trajectory = trajectory_of(arguments.folder);
  DcdReader file(trajectory);
  if (file.atoms() != scene.system.atoms())
    throw InputError(fmt::format("{}: its trajectory has {} atoms, its scene {}", arguments.folder.string(),
                                 file.atoms(), scene.system.atoms()));
  Measured measured(scene, arguments.atoms, file.interval());
  Vectors x;
  for (Box box = scene.start.box; file.next(x, box);) measured.add_frame(x, box);
  if (measured.frames() == 0) throw InputError(trajectory.string() + ": has no frame");
  measured.print();
  if (json_alone())
    write_out(measured.json().dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (!arguments.out) return;
  make_folder(*arguments.out);
  StudyFiles files(*arguments.out);
  measured.draw(files);
  files.print_written();
}

}  // namespace

void add_measure(Commands& commands) {
  auto arguments = std::make_shared<MeasureArguments>();
  const Subcommand command = commands.add(
      "measure", "of a run's trajectory: radial distribution, displacement and diffusion, length of chains",
      [arguments] { measure_folder(*arguments); });
  command.option("folder", arguments->folder, "what the run was given as --out").required();
  command
      .option("--atoms", arguments->atoms,
              "pairs of the radial distribution, by name: OW HW1 (if not said: the heaviest)")
      .words(2, "NAME NAME");
  command.option("--out", arguments->out, "folder for distances.csv, displacement.csv and their pictures");
  command.flag("--overwrite", arguments->overwrite, "replace what --out holds");
  command.json("all figures as JSON");
}

}  // namespace taut
