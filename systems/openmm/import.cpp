#include "systems/openmm/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "files/text_file.hpp"
#include "forcefield/bonded/tabulated.hpp"
#include "forcefield/check_terms.hpp"
#include "forcefield/term_lists.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/openmm/forces.hpp"
#include "systems/openmm/images.hpp"
#include "systems/openmm/lennard_jones.hpp"
#include "systems/openmm/sites.hpp"
#include "systems/openmm/terms.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {
namespace {

// Returns "force 3: CustomBondForce "spring"".
std::string title(const Element& force, std::size_t index) {
  const std::string type = force.text("type"), name = force.has_attribute("name") ? force.text("name") : type;
  return fmt::format("force {}: {}", index, name == type ? type : fmt::format("{} \"{}\"", type, name));
}

// A force and its position in the file. It must not be moved.
struct PlacedForce {
  PlacedForce(const Element& element, std::size_t index)
      : name(title(element, index)), at(element.named(name)) {}
  PlacedForce(const PlacedForce&) = delete;
  PlacedForce& operator=(const PlacedForce&) = delete;

  bool periodic() const { return force.takes_images || force.periodic_pairs.value_or(false); }

  std::string name;
  Element at;
  OpenMMForce force{};
};
using PlacedForces = std::deque<PlacedForce>;

void check_version(const Element& root) {
  if (root.text("version") != "1")
    root.refuse(fmt::format("has version=\"{}\", expected 1", root.text("version")));
}

Vec3 read_vector(const Element& element) {
  Vec3 v;
  element.read_leaf(coordinates(v));
  return v;
}

System read_atoms(const Element& particles) {
  Eigen::VectorXd mass(static_cast<Eigen::Index>(particles.count()));
  const int atoms = static_cast<int>(mass.size());
  VirtualSites sites;
  int a = 0;
  particles.each("Particle", [&](const Element& particle) {
    particle.read({{"mass", &mass[a]}});
    if (mass[a] < 0) particle.refuse(fmt::format("atom {} has mass {}, expected 0 or more", a, mass[a]));
    if (particle.count() > 0) sites.push_back(read_site(particle, a, atoms));
    ++a;
  });
  try {
    return make_system(std::move(mass), {}, std::move(sites));
  } catch (const InputError& e) {
    particles.refuse(e.what());
  }
}

void add_bonds(const Element& constraints, const System& atoms, std::vector<RigidBond> bonds,
               OpenMMInput& to) {
  // A constraint between two anchors has no effect; OpenMM ignores it, too.
  const auto idle = std::stable_partition(bonds.begin(), bonds.end(), [&](const RigidBond& b) {
    return b.i == b.j || !atoms.is_anchor(b.i) || !atoms.is_anchor(b.j);
  });
  if (idle != bonds.end())
    to.notes.push_back(fmt::format(
        "constraints: {} between two atoms of mass 0, the first {}-{}, left out: neither atom moves",
        bonds.end() - idle, idle->i, idle->j));
  bonds.erase(idle, bonds.end());
  try {
    to.system = make_system(atoms.mass, std::move(bonds), atoms.sites);
  } catch (const InputError& e) {
    constraints.refuse(fmt::format("among its constraints, {}", e.what()));
  }
}

Vectors read_vectors(const Element& list, const char* each, const char* what, int atoms) {
  if (list.count() != static_cast<std::size_t>(atoms))
    list.refuse(fmt::format("has {} {}, but the system has {} atoms", list.count(), what, atoms));
  Vectors to(3, atoms);
  Eigen::Index a = 0;
  list.each(each, [&](const Element& element) { to.col(a++) = read_vector(element); });
  return to;
}

Box read_box(const Element& vectors) {
  vectors.read({});
  vectors.check_parts({"A", "B", "C"});
  Eigen::Matrix3d edges;
  int c = 0;
  for (const char* name : {"A", "B", "C"}) edges.col(c++) = read_vector(vectors.part(name));
  if (const std::string flaw = Box::flaw(edges); !flaw.empty()) vectors.refuse("its box has " + flaw);
  return Box::of(edges);
}

// Reads the virtual sites; their positions in the State are ignored.
void place(const Element& state, OpenMMInput& input) {
  try {
    place_sites(input.system.sites, input.start.x);
  } catch (const SimulationFailure& e) {
    state.part("Positions").refuse(e.what());
  }
  if (!input.start.x.allFinite()) state.part("Positions").refuse("a virtual site is at no finite place");
}

void read_start(const Element& state, OpenMMInput& to) {
  const int atoms = to.system.atoms();
  state.read({{"time", &to.start.t}}, {"openmmVersion", "stepCount", "type", "version"});
  check_version(state);
  state.check_parts({}, {"PeriodicBoxVectors", "Parameters", "Energies", "Positions", "Velocities", "Forces",
                         "IntegratorParameters"});
  if (!state.has("Positions")) state.refuse("has no positions");
  to.start.x = read_vectors(state.part("Positions"), "Position", "positions", atoms);
  to.has_velocities = state.has("Velocities");
  to.start.v = to.has_velocities ? read_vectors(state.part("Velocities"), "Velocity", "velocities", atoms)
                                 : Vectors::Zero(3, atoms);
  for (int a = 0; a < atoms; ++a)
    if (to.system.mass[a] == 0)
      to.start.v.col(a).setZero();  // atoms without mass do not move, whatever the State says
  to.start.f = Vectors::Zero(3, atoms);
  place(state, to);
  if (state.has("IntegratorParameters") && !state.part("IntegratorParameters").empty())
    to.notes.emplace_back(
        "start: what the State has of OpenMM's integrator (IntegratorParameters) is not used");
}

std::map<std::string, double> read_context_parameters(const Element& state) {
  return state.has("Parameters") ? state.part("Parameters").numbers() : std::map<std::string, double>();
}

void read_forces(const Element& list, const Element& state, const System& system, PlacedForces& forces) {
  ContextParameters context(read_context_parameters(state));
  list.each("Force", [&](const Element& element) {
    PlacedForce& placed = forces.emplace_back(element, forces.size());
    placed.force = read_force(placed.at, system, context);
  });
  if (const auto name = context.undeclared())
    state.part("Parameters")
        .refuse(fmt::format("the State sets the parameter {}, which no force of the System declares", *name));
}

// Returns the box for all forces: the State's, or the System's if the State has none.
Box box_of(const PlacedForces& forces, const Element& system, const Element& state) {
  const auto periodic = std::find_if(forces.begin(), forces.end(), std::mem_fn(&PlacedForce::periodic));
  if (periodic == forces.end()) return {};
  for (const PlacedForce& f : forces)
    if (f.force.periodic_pairs == false)
      f.at.refuse(
          fmt::format("its pairs are not periodic, but {} is: taut has one box for all", periodic->name));
  return read_box((state.has("PeriodicBoxVectors") ? state : system).part("PeriodicBoxVectors"));
}

// Adds the force to the message of an exception.
void of_force(const PlacedForce& f, const auto& act) {
  try {
    act();
  } catch (const InputError& e) {
    f.at.refuse(e.what());
  }
}

// Makes broken molecules whole. `constraints` includes those of anchors.
void mend_molecules(const PlacedForces& forces, const std::vector<RigidBond>& constraints,
                    const Element& state, OpenMMInput& input) {
  const System& sys = input.system;
  std::vector<Tether> tethers;
  for (const auto& b : constraints)  // one between two anchors holds nothing
    tethers.push_back({b.i, b.j,
                       sys.is_anchor(b.i) && sys.is_anchor(b.j) ? Tether::By::kSpring : Tether::By::kBond,
                       b.length});
  for (const PlacedForce& f : forces) add_tethers(f.force.terms, tethers);
  add_tethers(sys.sites, tethers);
  const Vectors as_given = input.start.x;
  try {
    make_whole(tethers, input.start, input.system);
  } catch (const InputError& e) {
    state.part("Positions").refuse(e.what());
  }
  const WholeMolecules molecules{input.system, input.start.box, as_given, input.start.x,
                                 taut::molecules(sys.atoms(), pairs_of(tethers))};
  check_images(state.part("Positions"), sys.sites, molecules);
  place(state, input);
  for (const PlacedForce& f : forces) check_images(f.at, f.force, molecules);
}

void refuse_angstrom(const PlacedForces& forces, const OpenMMInput& input, const Element& state) {
  std::vector<HarmonicBond> springs;
  for (const PlacedForce& f : forces)
    springs.insert(springs.end(), f.force.terms.bonds.begin(), f.force.terms.bonds.end());
  if (const std::string doubt = angstrom_doubt(input.system.bonds, springs, input.start.x); !doubt.empty())
    state.part("Positions").refuse(doubt);
}

template <class Term>
void add_all(std::vector<Term>& to, const std::vector<Term>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <class Part>
void add_one(const Element& at, std::optional<Part>& to, std::optional<Part>& from) {
  if (to && from) at.refuse("is the second of its kind: taut has one");
  if (from) to = std::move(from);
}

// Biases are called as their forces are, where columns of the log can be, and else by their number.
void add_biases(std::vector<Bias>& to, std::vector<Bias>& from) {
  for (Bias& bias : from) {
    const auto part_of_a_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    };
    const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    if (!std::ranges::all_of(bias.name, part_of_a_name) || std::ranges::all_of(bias.name, digit) ||
        std::ranges::find(to, bias.name, &Bias::name) != to.end())
      bias.name = std::to_string(to.size());
    to.push_back(std::move(bias));
  }
}

void add(PlacedForce& placed, OpenMMInput& input) {
  Terms &from = placed.force.terms, &to = input.terms;
  for_each_list([&](auto list) { add_all(to.*list, from.*list); });
  for (CmapTorsion& t : from.cmaps) t.map += static_cast<int>(to.maps.size());
  add_all(to.maps, from.maps);
  add_all(to.cmaps, from.cmaps);
  add_all(to.pulls, from.pulls);
  add_all(to.restraints, from.restraints);
  add_all(to.walls, from.walls);
  add_biases(to.biases, from.biases);
  add_one(placed.at, to.nonbonded, from.nonbonded);
  add_one(placed.at, to.wca, from.wca);
  add_one(placed.at, to.tabulated_pairs, from.tabulated_pairs);
  if (from.gravity) to.gravity = to.gravity.value_or(Vec3::Zero()) + *from.gravity;
  for (const auto& note : placed.force.notes) input.notes.push_back(fmt::format("{} {}", placed.name, note));
  add_one(placed.at, input.barostat, placed.force.barostat);
  if (placed.force.remove_momentum_every == 0) return;
  if (input.remove_momentum_every != 0) placed.at.refuse("is the second of its kind: one is enough");
  input.remove_momentum_every = placed.force.remove_momentum_every;
}

}  // namespace

OpenMMInput read_openmm(const XmlFile& system_file, const XmlFile& state_file) {
  const Element system = system_file.root(), state = state_file.root();
  system.read({}, {"openmmVersion", "type", "version"});
  check_version(system);
  system.check_parts(
      {"PeriodicBoxVectors", "Particles", "Constraints", "Forces"});  // the State's box takes precedence

  OpenMMInput input;
  const System atoms = read_atoms(system.part("Particles"));
  std::vector<RigidBond> constraints;
  read_list(system, constraints, atoms.atoms());
  hear();
  add_bonds(system.part("Constraints"), atoms, constraints, input);
  read_start(state, input);

  PlacedForces forces;
  read_forces(system.part("Forces"), state, input.system, forces);
  input.start.box = box_of(forces, system, state);
  const auto of_each = [&](const auto& act) {
    for (PlacedForce& f : forces) {
      hear();
      of_force(f, [&] { act(f); });
    }
  };
  of_each([&](const PlacedForce& f) { check_terms(input.system, input.start.box, f.force.terms); });
  refuse_angstrom(forces, input, state);
  if (input.start.box.periodic()) mend_molecules(forces, constraints, state, input);
  of_each([&](const PlacedForce& f) { check_tables_cover(input.system, f.force.terms, input.start.x); });
  for (PlacedForce& f : forces) add(f, input);
  bool has_types = false;
  of_each([&](PlacedForce& f) {
    if (!f.force.lennard_jones) return;
    if (has_types) f.at.refuse("is the second of its kind: taut has one");
    add_lennard_jones(std::move(*f.force.lennard_jones), input.terms.nonbonded);
    has_types = true;
  });
  of_each([&](const PlacedForce& f) { add_pairs(f.force.pairs, input.terms.nonbonded); });
  of_each([&](const PlacedForce& f) { add_excluded_field(f.force.excluded_charges, input.terms.nonbonded); });
  return input;
}

OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml) {
  const XmlFile system(system_xml, "System"), state(state_xml, "State");
  return read_openmm(system, state);
}

namespace {

// Returns "water" for "water.system.xml", and for the same compressed.
std::string scene_name(const std::filesystem::path& file) {
  const std::filesystem::path stem = without_compression(file).stem();
  return (stem.extension() == ".system" ? stem.stem() : stem).string();
}

}  // namespace

Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml) {
  const XmlFile system(system_xml, "System"), state(state_xml, "State");
  return import_openmm(system, state);
}

Scene import_openmm(const XmlFile& system, const XmlFile& state) {
  OpenMMInput input = read_openmm(system, state);
  hear();
  Scene scene;
  scene.name = scene_name(system.path());
  scene.files = {system.path(), state.path()};
  scene.hard_on = "what OpenMM was given";
  scene.system = std::move(input.system);
  scene.terms = std::move(input.terms);
  scene.names = guessed_names(scene.system, scene.terms);
  scene.start = std::move(input.start);
  scene.notes = std::move(input.notes);
  scene.run.remove_momentum_every = input.remove_momentum_every;
  if (input.barostat) {
    scene.run.barostat = "monte-carlo";
    scene.run.pressure_bar = input.barostat->pressure_bar;
    scene.run.barostat_every = input.barostat->every;
  }
  scene.method = default_options(kUsualMethod);
  return scene;
}

namespace {

// True if the System has hydrogens, of up to 4 u, and a rigid bond holds each of them.
bool holds_hydrogens(const System& sys) {
  std::vector<bool> held(sys.atoms());
  for (const RigidBond& bond : sys.bonds) held[bond.i] = held[bond.j] = true;
  bool any = false;
  for (int atom = 0; atom < sys.atoms(); ++atom) {
    if (sys.mass[atom] == 0 || sys.mass[atom] >= 4) continue;
    if (!held[atom]) return false;
    any = true;
  }
  return any;
}

}  // namespace

// Mixed precision differs from double by 1e-6 of the forces and takes two thirds of the time (docs/running.md).
// Where a rigid bond holds each hydrogen, 2 fs keep the energy (benchmarks/README.md).
std::map<std::string, std::string> take_usual_settings(Scene& imported) {
  std::map<std::string, std::string> taken;
  if (imported.terms.nonbonded || imported.terms.wca)
    imported.terms.precision = Precision::kMixed, taken["forcefield.precision"] = "mixed";
  if (holds_hydrogens(imported.system)) imported.run.dt_fs = 2, taken["run.dt_fs"] = "2";
  return taken;
}

OpenMMInput openmm_input(const Scene& scene) {
  if (!scene.motions.empty())
    throw InputError(
        fmt::format("OpenMM cannot express it: atom {} is an anchor that moves (motion.0), and OpenMM's "
                    "particles of mass 0 stand",
                    scene.motions.front().atoms.front()));
  if (scene.run.metric_correction)
    throw InputError(
        "OpenMM cannot express it: run.metric_correction, Fixman's potential, depends on all bonds of a "
        "molecule");
  return {scene.system, scene.terms, scene.start, scene.run.remove_momentum_every};
}

}  // namespace taut
