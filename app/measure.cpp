#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "files/atomic_file.hpp"
#include "files/dcd_reader.hpp"
#include "md/errors.hpp"
#include "md/nearest_name.hpp"
#include "pictures.hpp"
#include "simulation/checkpoint.hpp"
#include "studies/liquid_structure.hpp"
#include "study.hpp"
#include "words.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct MeasureArguments {
  fs::path folder;
  std::vector<std::string> atoms;  // of the radial distribution, by name
  std::optional<fs::path> out;
  bool json = false, overwrite = false;
};

// What is measured of a trajectory.
struct Measured {
  const Scene& scene;
  std::vector<std::string> atoms;
  RadialDistribution pairs;
  EndToEnd chains;
  MeanSquareDisplacement motion;
  long frames = 0;
  double interval;  // [ps]

  std::string of_pairs() const { return fmt::format("{}–{}", atoms[0], atoms[1]); }
};

fs::path trajectory_of(const fs::path& folder) {
  fs::path file = folder / "trajectory.dcd";
  if (fs::exists(file)) return file;
  const bool other = fs::exists(folder / "trajectory.h5md");
  throw InputError(fmt::format(
      "{}: no such file; {}", file.string(),
      other ? "run with run.trajectory = \"dcd\" or \"both\"" : "run with --set run.trajectory_every=100"));
}

std::vector<int> atoms_named(const Scene& scene, const std::string& name) {
  std::vector<int> atoms;
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (scene.names.kinds[static_cast<std::size_t>(scene.names.kind[a])].atom == name) atoms.push_back(a);
  if (!atoms.empty()) return atoms;
  std::vector<std::string_view> names;
  for (const AtomKind& kind : scene.names.kinds) names.emplace_back(kind.atom);
  throw InputError(fmt::format("--atoms: there is no atom \"{}\"{}", name, did_you_mean(name, names)));
}

// The heaviest atom's name: O of water, the beads of a chain.
std::string heaviest(const Scene& scene) {
  Eigen::Index a = 0;
  scene.system.mass.maxCoeff(&a);
  return scene.names.kinds[static_cast<std::size_t>(scene.names.kind[a])].atom;
}

Measured measure(const Scene& scene, const MeasureArguments& arguments) {
  DcdReader file(trajectory_of(arguments.folder));
  if (file.atoms() != scene.system.atoms())
    throw InputError(fmt::format("{}: its trajectory has {} atoms, its scene {}", arguments.folder.string(),
                                 file.atoms(), scene.system.atoms()));
  std::vector<std::string> atoms = arguments.atoms;
  if (atoms.empty()) atoms.assign(2, heaviest(scene));
  const std::vector<int> molecule = molecules_of(scene.system, scene.terms);
  const Box& start = scene.start.box;
  const double reach = start.periodic() ? std::min(1.0, start.edge.minCoeff() / 2) : 0;
  Measured m{.scene = scene,
             .atoms = atoms,
             .pairs = RadialDistribution(atoms_named(scene, atoms[0]), atoms_named(scene, atoms[1]), molecule,
                                         reach),
             .chains = EndToEnd(chain_ends(scene.system, scene.terms)),
             .motion = MeanSquareDisplacement(scene.system.mass, molecule, file.interval()),
             .interval = file.interval()};
  Vectors x;
  for (Box box = start; file.next(x, box); ++m.frames) {
    if (reach > 0 && !m.pairs.empty()) m.pairs.see(x, box);
    if (!m.chains.empty()) m.chains.see(x);
    m.motion.see(x);
  }
  if (m.frames == 0) throw InputError(trajectory_of(arguments.folder).string() + ": has no frame");
  return m;
}

std::string with_error(const Estimate& e) {
  return e.error > 0 ? fmt::format("{:.4g} ± {:.1g}", e.value, e.error)
                     : fmt::format("{:.4g} (too few frames for an error)", e.value);
}

std::string distances_csv(const Measured& m, const Distances& g) {
  std::string text = "run,r_nm,g,standard_error\n";
  for (std::size_t n = 0; n < g.r.size(); ++n)
    text += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", m.of_pairs(), g.r[n], g.g[n].value, g.g[n].error);
  return text;
}

std::string displacement_csv(const MeanSquareDisplacement::Result& moved) {
  std::string text = "t_ps,squared_nm2,standard_error\n";
  for (std::size_t n = 0; n < moved.t.size(); ++n)
    text += fmt::format("{:.6g},{:.6g},{:.2g}\n", moved.t[n], moved.squared[n].value, moved.squared[n].error);
  return text;
}

void print(const Measured& m, const Distances& g, const MeanSquareDisplacement::Result& moved) {
  fmt::print("{}: {} of {}, {:.4g} ps apart\n", m.scene.name, counted(m.frames, "frame"),
             counted(m.scene.system.atoms(), "atom"), m.interval);
  if (!g.r.empty()) {
    const auto peak = std::ranges::max_element(g.g, {}, &Estimate::value) - g.g.begin();
    fmt::print("g(r) of {}, in other molecules: highest {} at {:.3f} nm\n", m.of_pairs(),
               with_error(g.g[static_cast<std::size_t>(peak)]), g.r[static_cast<std::size_t>(peak)]);
  }
  if (!m.chains.empty())
    fmt::print("end to end: ⟨R²⟩ = {} nm², √⟨R²⟩ = {} nm\n", with_error(m.chains.squared()),
               with_error(m.chains.root()));
  if (moved.t.empty())
    return fmt::print("mean-square displacement: {} frames are too few, it takes 40\n", m.frames);
  fmt::print("molecules' displacement: ⟨Δr²⟩ = {} nm² after {:.4g} ps\n", with_error(moved.squared.back()),
             moved.t.back());
  const Estimate& d = moved.diffusion;
  constexpr double kCm2PerS = 1e-2, kStraight = 0.2;  // of nm²/ps
  if (std::abs(moved.exponent - 1) > kStraight)
    return fmt::print("no D yet: the displacement grows as t^{:.2f}, it takes longer until it grows as t\n",
                      moved.exponent);
  fmt::print("diffusion: D = {} nm²/ps ({:.3g} cm²/s), the slope from {:.4g} to {:.4g} ps\n", with_error(d),
             d.value * kCm2PerS, moved.t.back() / 2, moved.t.back());
}

void measure_folder(const MeasureArguments& arguments) {
  expect_checkpoint(arguments.folder);
  if (arguments.out)
    expect_no_file({*arguments.out / "distances.csv", *arguments.out / "displacement.csv"},
                   arguments.overwrite);
  const Scene scene = load_checkpoint(arguments.folder).source.read();
  const Measured m = measure(scene, arguments);
  const Distances g = m.pairs.result();
  const MeanSquareDisplacement::Result moved = m.motion.result();
  if (arguments.json) {
    nlohmann::ordered_json json = {{"scene", scene.name}, {"frames", m.frames}, {"interval_ps", m.interval}};
    const auto estimate = [](const Estimate& e) {
      return nlohmann::ordered_json{{"value", e.value}, {"error", e.error}};
    };
    if (!m.chains.empty()) json["end_to_end_squared_nm2"] = estimate(m.chains.squared());
    if (!moved.t.empty()) {
      json["diffusion_nm2_per_ps"] = estimate(moved.diffusion);
      json["displacement_exponent"] = moved.exponent;
    }
    for (std::size_t n = 0; n < moved.t.size(); ++n)
      json["displacement"].push_back({moved.t[n], moved.squared[n].value, moved.squared[n].error});
    for (std::size_t n = 0; n < g.r.size(); ++n)
      json["distances"].push_back({g.r[n], g.g[n].value, g.g[n].error});
    fmt::print("{}\n", json.dump(2));
  } else {
    print(m, g, moved);
  }
  if (!arguments.out) return;
  make_folder(*arguments.out);
  StudyFiles files(*arguments.out);
  if (!g.r.empty())
    files.draw({"distances",
                fmt::format("{}: radial distribution of {}, bars: standard errors", scene.name, m.of_pairs()),
                distances_csv(m, g)});
  if (!moved.t.empty())
    files.draw({"displacement", scene.name + ": mean-square displacement of molecules, bars: standard errors",
                displacement_csv(moved)});
  if (!arguments.json) files.tell();
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
  command.flag("--json", arguments->json, "all figures as JSON");
}

}  // namespace taut
