#include "systems/builders/biases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/words.hpp"
#include "systems/builders/named_atoms.hpp"
#include "systems/molecules/rows.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

constexpr double kNoWall = std::numeric_limits<double>::infinity();
constexpr double kDegree = std::numbers::pi / 180;

void read_groups(const TomlTable& keys, const Scene& scene, Bias& bias) {
  const std::size_t groups = keys.size(
      "groups",
      "the atoms of each centre, as [[0, 1], \"10-29\", \"CA\", -1]: indices from 0 (-1: the last), spans, "
      "names; a centre is of mass");
  if (keys.describing()) return;
  const auto expected = static_cast<std::size_t>(groups_of(bias.variable));
  if (groups != expected)
    keys.fail(keys.has("groups") ? "groups" : "variable",
              fmt::format("{} needs {} of atoms in `groups`, got {}", name_of(bias.variable),
                          counted(static_cast<long>(expected), "group"), groups));
  for (std::size_t g = 0; g < groups; ++g) {
    bias.groups.push_back(make_group(scene.system, read_named_atoms(keys, "groups", g, scene)));
  }
}

// Reads a number that has a key in nm and one in degrees, of which one counts for a variable.
class Reader {
 public:
  Reader(const TomlTable& keys, bool angular) : keys_(keys), angular_(angular) {}

  std::optional<double> read(const char* in_nm, const About& about_nm, const char* in_degrees,
                             const About& about_degrees, double unit = kDegree) const {
    std::optional<double> nm, degrees;
    keys_.read(in_nm, nm, about_nm);
    keys_.read(in_degrees, degrees, about_degrees);
    keys_.require_effect(in_nm, !angular_, "with variable = \"distance\" or \"gyration\"");
    keys_.require_effect(in_degrees, angular_, "with variable = \"angle\" or \"torsion\"");
    if (degrees) *degrees *= unit;
    return angular_ ? degrees : nm;
  }
  const char* key(const char* in_nm, const char* in_degrees) const { return angular_ ? in_degrees : in_nm; }

 private:
  const TomlTable& keys_;
  bool angular_;
};

void read_law(const TomlTable& keys, double start, Bias& bias) {
  const Reader reader(keys, bias.angular());
  const auto at =
      reader.read("at_nm", {"harmonic restraint ½k(ξ − at)²; not said: where the start has it", "nm"},
                  "at_deg", {"the same of an angle or a torsion", "°"});
  const auto least = reader.read("at_least_nm", {"lower wall: ½k(ξ − at_least)² below it", "nm"},
                                 "at_least_deg", {"the same of an angle or a torsion", "°"});
  const auto most = reader.read("at_most_nm", {"upper wall: ½k(ξ − at_most)² above it", "nm"}, "at_most_deg",
                                {"the same of an angle or a torsion", "°"});
  const auto rate =
      reader.read("rate_nm_ps", {"speed at which `at`, or the walls, move from the start on", "nm/ps"},
                  "rate_deg_ps", {"the same of an angle or a torsion", "°/ps"});
  const auto k =
      reader.read("k_kj_mol_nm2", {"k of the restraint or the walls", "kJ/mol/nm²", kPositive},
                  "k_kj_mol_rad2", {"the same of an angle or a torsion", "kJ/mol/rad²", kPositive}, 1);
  const auto force =
      reader.read("force_kj_mol_nm", {"constant pull F, E = −Fξ, towards larger values", "kJ/mol/nm"},
                  "torque_kj_mol_rad", {"the same of an angle", "kJ/mol/rad"}, 1);
  if (keys.describing()) return;
  if (k.has_value() == force.has_value())
    keys.fail("variable", fmt::format("expected {} (a restraint or walls), or {} (a constant pull)",
                                      reader.key("k_kj_mol_nm2", "k_kj_mol_rad2"),
                                      reader.key("force_kj_mol_nm", "torque_kj_mol_rad")));
  for (const char* key : {"at", "at_least", "at_most", "rate"}) {
    const bool of_rate = std::string_view(key) == "rate";
    const std::string name =
        key + std::string(of_rate ? reader.key("_nm_ps", "_deg_ps") : reader.key("_nm", "_deg"));
    keys.require_effect(name, k.has_value(), "with a k");
  }
  if (at && (least || most))
    keys.fail(reader.key("at_nm", "at_deg"), "expected either this or walls, at_least and at_most");
  const bool walls = least || most;
  bias.lower = walls ? least.value_or(-kNoWall) : at.value_or(start);
  bias.upper = walls ? most.value_or(kNoWall) : bias.lower;
  bias.k = k.value_or(0);
  bias.force = force.value_or(0);
  bias.rate = rate.value_or(0);
}

void check_name(const TomlTable& keys, const std::string& name) {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  if (name.empty() || !std::ranges::all_of(name, plain))
    keys.fail("name", "expected letters, digits and _, as it is part of columns' names");
}

// Reads all but the law, for which atoms have to be together.
Bias read_variable(const TomlTable& keys, std::size_t number, const Scene& scene) {
  Bias bias;
  bias.name = std::to_string(number);
  const std::string variable = keys.choice(
      "variable", {"distance", "angle", "torsion", "gyration"},
      "ξ: r of two centres, the angle or the torsion of three or four, R_g of the atoms of one group");
  bias.variable = variable == "distance"  ? Bias::Variable::kDistance
                  : variable == "angle"   ? Bias::Variable::kAngle
                  : variable == "torsion" ? Bias::Variable::kTorsion
                                          : Bias::Variable::kGyration;
  if (keys.read("name", bias.name, "what columns of the log call it; not said: its number"))
    check_name(keys, bias.name);
  std::optional<Vec3> along;
  keys.read("along", along,
            "direction [x, y, z]: ξ is the separation's component, with its sign, instead of r");
  keys.require_effect("along", variable == "distance", "with variable = \"distance\"");
  read_groups(keys, scene, bias);
  if (along && !(along->norm() > 0)) keys.fail("along", "expected a direction that is not 0, as [0, 0, 1]");
  if (along) bias.variable = Bias::Variable::kComponent, bias.along = along->normalized();
  if (keys.describing()) return bias;
  if (const std::string flaw = flaw_of_groups(bias, scene.system); !flaw.empty()) keys.fail("groups", flaw);
  if (const std::string flaw = flaw_of_direction(bias, scene.start.box); !flaw.empty())
    keys.fail("along", flaw);
  return bias;
}

// Where the start leaves a bias without direction, it does not act before something else breaks the symmetry.
void note_lost(const Scene& scene, std::vector<std::string>& notes) {
  Vectors f = Vectors::Zero(3, scene.system.atoms());
  BiasForces forces;
  try {
    add_biases(scene.terms.biases, scene.start, f, forces);
  } catch (const SimulationFailure& e) {
    throw LocatedError(e.what());
  }
  for (std::size_t b = 0; b < forces.readings.size(); ++b)
    if (forces.readings[b].lost)
      notes.push_back(fmt::format(
          "start: bias {} does not act: its {} has no direction where centres coincide or lie in a "
          "line",
          scene.terms.biases[b].name, name_of(scene.terms.biases[b].variable)));
}

}  // namespace

int bring_together(const std::vector<Bias>& biases, const System& sys, const Terms& terms, const Box& box,
                   Vectors& x) {
  if (!box.periodic() || biases.empty()) return 0;
  const std::vector<int> molecule = molecules(sys, terms);
  std::map<int, Vec3> moved;  // by how many box vectors
  for (const Bias& bias : biases)
    for (const BiasGroup& group : bias.groups)
      for (const int a : group.atoms) {
        const auto [at, fresh] = moved.try_emplace(molecule[a], Vec3::Zero());
        if (!fresh) continue;
        const int first = group.atoms.front();
        const Vec3 from = x.col(first) - box.lattice_vector(moved.at(molecule[first]));
        at->second = box.cell_of(x.col(a) - from, std::round);
        for (const Wall& wall : terms.walls) at->second[wall.axis] = 0;  // not through a wall
      }
  int count = 0;
  for (const auto& [m, cell] : moved) count += !cell.isZero(0);
  if (count == 0) return 0;
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    if (const auto at = moved.find(molecule[a]); at != moved.end())
      x.col(a) -= box.lattice_vector(at->second);
  return count;
}

void read_biases(const TomlTable& root, Scene& scene) {
  if (root.describing()) {
    const TomlTable own = root.section("bias");
    Bias bias = read_variable(own, 0, scene);
    read_law(own, 0, bias);
  }
  const std::size_t count = root.size(
      "bias", {"potentials of a distance, an angle, a torsion or R_g of groups, a section [[bias]] each"});
  if (count == 0) return;
  std::vector<Bias>& all = scene.terms.biases;
  const std::size_t there = all.size();  // those that a System has
  for (std::size_t k = 0; k < count; ++k) {
    const TomlTable own = root.section("bias", k);
    Bias bias = read_variable(own, there + k, scene);
    if (std::ranges::find(all, bias.name, &Bias::name) != all.end())
      own.fail("name", fmt::format("a second bias is called \"{}\"", bias.name));
    all.push_back(std::move(bias));
  }
  if (const int moved = bring_together(all, scene.system, scene.terms, scene.start.box, scene.start.x))
    scene.notes.push_back(
        fmt::format("start: {} of biases' groups moved by vectors of the box, to where the others of the "
                    "group are",
                    counted(moved, "molecule")));
  for (std::size_t k = 0; k < count; ++k) {
    const TomlTable own = root.section("bias", k);
    for (const char* known : {"variable", "name", "along", "groups"}) own.has(known);
    Bias& bias = all[there + k];
    bias.since = scene.start.t;
    read_law(own, value_of(bias, scene.start.box, scene.start.x), bias);
    if (const std::string flaw = flaw_of_walls(bias, scene.start.box); !flaw.empty())
      own.fail("variable", flaw);
    own.reject_unknown();
  }
  tie_steered_atoms(scene.start, scene.terms);  // molecules may have been moved
  note_lost(scene, scene.notes);
}

std::string in_words(const Bias& bias) {
  std::vector<std::size_t> atoms;
  for (const BiasGroup& group : bias.groups) atoms.push_back(group.atoms.size());
  const double unit = bias.angular() ? kDegree : 1;
  const char *of_value = bias.angular() ? "°" : " nm", *of_k = bias.angular() ? "rad" : "nm";
  const auto value = [&](double v) { return fmt::format("{:.6g}{}", v / unit, of_value); };
  std::string words = fmt::format("bias {}: {} of {} atom{}", bias.name, name_of(bias.variable),
                                  fmt::join(atoms, " and "), atoms == std::vector<std::size_t>{1} ? "" : "s");
  if (bias.variable == Bias::Variable::kComponent)
    words += fmt::format(" along [{:g}, {:g}, {:g}]", bias.along.x(), bias.along.y(), bias.along.z());
  if (bias.k == 0) return words + fmt::format(", pulled by {:g} kJ/mol/{}", bias.force, of_k);
  words += bias.lower == bias.upper ? fmt::format(", held at {}", value(bias.lower))
           : bias.lower == -kNoWall ? fmt::format(", at most {}", value(bias.upper))
           : bias.upper == kNoWall  ? fmt::format(", at least {}", value(bias.lower))
                                   : fmt::format(", between {} and {}", value(bias.lower), value(bias.upper));
  words += fmt::format(" by {:g} kJ/mol/{}²", bias.k, of_k);
  if (bias.rate != 0) words += fmt::format(", moving by {}/ps", value(bias.rate));
  return words;
}

}  // namespace taut
