#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/words.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "help.hpp"
#include "printing.hpp"
#include "run_tables.hpp"
#include "scene_argument.hpp"
#include "simulation/temperatures.hpp"
#include "systems/builders/biases.hpp"
#include "systems/builders/motions.hpp"

namespace taut {
namespace {

using nlohmann::ordered_json;

struct InfoArguments : SceneArgument {
  InfoArguments() { as_run = true; }
};

// Names the forces of a scene, each with its count.
std::vector<std::string> forces_of(const Scene& scene) {
  const Terms& terms = scene.terms;
  std::vector<std::string> forces;
  const auto add = [&](std::size_t n, const char* one) {
    if (n > 0) forces.push_back(counted(static_cast<long>(n), one));
  };
  add(terms.bonds.size(), "spring");
  add(terms.fene.size(), "FENE spring");
  add(terms.angles.size(), "angle");
  add(terms.cosine_angles.size() + terms.cosine_squared_angles.size(), "cosine angle");
  add(terms.restricted_angles.size(), "restricted angle");
  add(terms.tabulated_bonds.size(), "tabulated bond");
  add(terms.tabulated_angles.size(), "tabulated angle");
  add(terms.torsions.size(), "torsion");
  add(terms.rb_torsions.size(), "Ryckaert–Bellemans torsion");
  add(terms.harmonic_torsions.size(), "harmonic torsion");
  add(terms.bending_torsions.size(), "combined bending–torsion");
  add(terms.cmaps.size(), "correction map");
  if (terms.wca) forces.emplace_back("repulsion of all pairs (WCA)");
  if (const auto& tables = terms.tabulated_pairs)
    forces.push_back(fmt::format("pairs by {} to {:g} nm",
                                 counted(static_cast<long>(tables->potentials.size()), "table"),
                                 tables->cutoff()));
  if (const auto& pairs = terms.nonbonded) {
    const bool charged = (pairs->charge.array() != 0).any();
    forces.push_back(
        fmt::format("Lennard-Jones{}{}{}{}{}{}", pairs->shifted ? " shifted to zero" : "",
                    !charged                 ? ""
                    : pairs->dielectric == 1 ? " and Coulomb"
                                             : fmt::format(" and Coulomb in ε = {:g}", pairs->dielectric),
                    pairs->cutoff ? fmt::format(" to {:g} nm", *pairs->cutoff) : " of all pairs",
                    !charged        ? ""
                    : pairs->pme    ? ", particle mesh Ewald"
                    : pairs->cutoff ? fmt::format(", reaction field of ε = {:g}", pairs->rf_dielectric)
                                    : "",
                    pairs->rf_excluded ? ", also between excluded charges" : "",
                    terms.precision == Precision::kMixed ? ", in mixed precision" : ""));
  }
  if (terms.gravity) forces.emplace_back("gravity");
  add(terms.pulls.size(), "pull");
  add(terms.restraints.size(), "position restraint");
  add(terms.walls.size(), "wall");
  add(terms.steered.size(), "steered atom");
  for (const Bias& bias : terms.biases) forces.push_back(in_words(bias));
  for (std::size_t m = 0; m < scene.motions.size(); ++m) forces.push_back(in_words(scene.motions[m], m));
  return forces;
}

// "216 molecules of 3 atoms".
std::vector<std::string> molecules_of(const Scene& scene) {
  const Temperatures types(scene.system, scene.terms, scene.start.x, true);
  std::vector<std::string> names;
  for (const MoleculeType& type : types.types()) names.push_back(type.name);
  return names;
}

// Returns the source of a value as the user typed it: --dt-fs 2 for --set run.dt_fs=2, or the scene's file.
std::string from(const Key& key, const InfoArguments& arguments, const std::vector<Key>& usual) {
  for (const KeyFlag& flag : arguments.flags())
    if (!flag.said.empty() && key.from == "--set " + flag.override_) return flag.said;
  if (!key.from.empty()) {
    const auto slash = key.from.starts_with("--set ") ? key.from.npos : key.from.rfind('/');
    return slash == key.from.npos ? key.from : key.from.substr(slash + 1);
  }
  const auto otherwise = std::ranges::find(usual, key.name(), &Key::name);
  const bool imported = !arguments.openmm.empty() && (key.section == "run" || key.section == "forcefield") &&
                        key.name() != "forcefield.precision" && key.name() != "run.dt_fs" &&
                        otherwise != usual.end() && otherwise->value != key.value;
  return imported ? "OpenMM's files" : "default";
}

// Returns a value as it is written in the scene.
std::string value_of(const Key& key, const Scene& scene) {
  if (key.value.empty()) return "not set";
  const std::string folder = "\"" + scene.files[0].parent_path().string() + "/";
  const bool beside = key.type == std::string_view("file") && key.value.starts_with(folder);
  return fmt::format("{} {}", beside ? "\"" + key.value.substr(folder.size()) : key.value, key.about.unit);
}

std::vector<Key> in_force(const KeysRead& read, const InfoArguments& arguments) {
  const std::vector<Key> usual = every_key();
  std::vector<Key> keys;
  for (const Key& key : read.all)
    if (key.read && !key.idle && key.name() != "hard_on") {
      keys.push_back(key);
      keys.back().from = from(key, arguments, usual);
    }
  // Grouped by the first word of the section: place.0.count belongs to place.
  std::ranges::stable_sort(keys, {}, [](const Key& key) {
    const auto first = [](std::string_view name) { return name.substr(0, name.find('.')); };
    const std::string name = key.name();
    return std::ranges::find(kSections, first(name), first) - kSections.begin();
  });
  return keys;
}

ordered_json as_json(const Scene& scene, const std::vector<Key>& keys) {
  ordered_json json = {{"scene", scene.name},
                       {"hard_on", scene.hard_on},
                       {"notes", scene.notes},
                       {"atoms", scene.system.atoms()},
                       {"virtual_sites", scene.system.sites.size()},
                       {"bonds", scene.system.bond_count()},
                       {"molecules", molecules_of(scene)},
                       {"forces", forces_of(scene)}};
  if (const Box& box = scene.start.box; box.periodic()) {  // as a scene has it
    const Eigen::Matrix3d m = box.vectors();
    json["box_nm"] = box.tilt.isZero(0) ? std::vector<double>(box.edge.begin(), box.edge.end())
                                        : std::vector<double>(m.data(), m.data() + 9);
  }
  for (const Key& key : keys) json["keys"].push_back(key_json(key));
  return json;
}

void info(const InfoArguments& arguments) {
  KeysRead read;
  const Scene scene = arguments.read(&read);
  const std::vector<Key> keys = in_force(read, arguments);
  if (json_alone()) return write_json(as_json(scene, keys));
  print_title(scene);
  const System& sys = scene.system;
  const auto line = [](const char* what, const std::vector<std::string>& all) {
    if (!all.empty())
      say("  {:<10} {}\n", what, wrapped(fmt::format("{}", fmt::join(all, "; ")), terminal_width(), 13));
  };
  std::vector<std::string> atoms = {counted(sys.atoms(), "atom")};
  if (!sys.sites.empty())
    atoms.push_back(counted(static_cast<long>(sys.sites.size()), "virtual site") + " among them");
  if (sys.anchors() > 0) atoms.push_back(fmt::format("{} of them anchored", sys.anchors()));
  if (sys.bond_count() > 0) atoms.push_back(counted(sys.bond_count(), "rigid bond"));
  if (!sys.one_sided.empty())
    atoms.push_back(counted(static_cast<long>(sys.one_sided.size()), "one-sided bond"));
  line("holds", atoms);
  line("molecules", molecules_of(scene));
  if (scene.start.box.periodic()) line("in a", {box_line(scene, scene.start.box)});
  line("forces", forces_of(scene));
  line("runs", {start_line(scene)});
  say("\n");
  std::vector<std::vector<std::string>> rows;
  for (const Key& key : keys) rows.push_back({"  " + key.name(), value_of(key, scene), key.from});
  say_text(table_text(rows, terminal_width()));
}

}  // namespace

void add_info(Commands& commands) {
  auto arguments = std::make_shared<InfoArguments>();
  const Subcommand command =
      commands.add("info", "what a scene holds, and all settings in force with who said each",
                   [arguments] { info(*arguments); });
  arguments->offer(command);
  command.json("as JSON");
}

}  // namespace taut
