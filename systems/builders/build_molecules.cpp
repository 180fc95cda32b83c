#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/listen.hpp"
#include "forcefield/force_field.hpp"
#include "md/largest_system.hpp"
#include "md/units.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/builders/pair_table.hpp"
#include "systems/builders/placements.hpp"
#include "systems/builders/repulsive_pairs.hpp"
#include "systems/builders/solvent.hpp"
#include "systems/molecules/placing.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

constexpr double kUsualKelvin = 300;  // default temperature at which torsions are drawn
constexpr double kOpen = std::numeric_limits<double>::infinity();  // no wall there
constexpr double kStrongForce = 20'000;  // on one atom, some ten times that in liquids [kJ/mol/nm]

// Places all copies: first those with given positions, last water.
class Builder {
 public:
  Builder(const BuildRequest& request, std::vector<Placement>& placements, const Box& box)
      : root_(request.root),
        placements_(placements),
        box_(box),
        may_overlap_(request.run.minimise && request.run.soft_start),
        random_(request.run.seed) {
    for (const WallKeys& wall : request.walls) rooms_.push_back(wall.room());
    const double kelvin = request.run.temperature_k > 0 ? request.run.temperature_k : kUsualKelvin;
    double widest = 0, room = 0;
    for (const Placement& placement : placements) {
      if (!conformations_.contains(placement.molecule)) try {
          conformations_.try_emplace(placement.molecule, *placement.molecule, kBoltzmann * kelvin);
        } catch (const InputError& e) {
          root_.section("molecule").fail(placement.molecule->name, e.what());
        }
      const Conformations& conformations = conformations_.at(placement.molecule);
      widest = std::max(widest, conformations.widest());
      room += static_cast<double>(placement.count) * std::pow(conformations.extent(), 3);
    }
    within_ = box.periodic() ? box : Box{Vec3::Constant(std::max(std::cbrt(room), 1e-6))};
    Placing placing(box, widest, random_, rooms_, may_overlap_);
    for (const auto& step : {&Builder::place_given, &Builder::place_on_lattice, &Builder::place_at_centres,
                             &Builder::place_at_random, &Builder::fill_with_water})
      for (std::size_t k = 0; k < placements.size(); ++k)
        if (placements[k].x.cols() == 0) (this->*step)(k, placing);
  }

  bool drawn() const { return drawn_; }
  bool cut_to_fit() const { return cut_to_fit_; }  // whether water was cut to fit among other molecules

 private:
  void place_given(std::size_t k, Placing& placing) {
    Placement& placement = placements_[k];
    if (placement.given.x.cols() == 0) return;
    placement.x = placement.given.x;
    placing.add_copies(of(placement), placement.x);
  }

  void place_at_centres(std::size_t k, Placing& placing) {
    Placement& placement = placements_[k];
    if (placement.centres.cols() == 0) return;
    place_copies(k, placing, [&](long m) { return Vec3(placement.centres.col(m)); });
  }

  void place_on_lattice(std::size_t k, Placing& placing) {
    if (!placements_[k].lattice) return;
    const BoxRegion region = region_of(placements_[k]);
    const RegionGrid grid(region.edge, placements_[k].count);
    place_copies(k, placing, [&](long m) { return Vec3(region.corner + grid.site(m)); });
  }

  void place_at_random(std::size_t k, Placing& placing) {
    if (placements_[k].fills || (placements_[k].equilibrated && box_.periodic())) return;
    const BoxRegion region = region_of(placements_[k]);
    place_copies(k, placing, [&](long) {
      const Vec3 share = random_.uniform_vector();
      return placements_[k].within || !rooms_.empty() ? Vec3(region.corner + share.cwiseProduct(region.edge))
                                                      : within_.lattice_vector(share);
    });
  }

  template <class Where>
  void place_copies(std::size_t k, Placing& placing, Where where) {
    Placement& placement = placements_[k];
    drawn_ = true;
    const int each = placement.molecule->atoms();
    placement.x.resize(3, each * placement.count);
    for (long m = 0; m < placement.count; ++m) {
      hear();
      const auto copy = placing.place_copy(of(placement), [&] { return where(m); });
      if (!copy)
        root_.fail("place", k,
                   fmt::format("there is no room for copy {} of {} of \"{}\": take fewer, or a wider box{}",
                               m + 1, placement.count, placement.molecule->name,
                               may_overlap_ ? ""
                                            : "; or run.minimise = true with run.soft_start = true, which "
                                              "parts molecules that overlap"));
      placement.x.middleCols(m * each, each) = *copy;
    }
  }

  // Fills the box with water; if the requested number does not fit, from denser and denser water.
  void fill_with_water(std::size_t k, Placing& placing) {
    Placement& placement = placements_[k];
    if (!box_.periodic())
      root_.fail("place", k, "water without a count fills a box: say build.box_nm, or a count");
    const State bulk = read_start(scenes_folder() / "water216.start.toml");
    const double usual = static_cast<double>(bulk.x.cols()) / 3 / bulk.box.volume() * box_.volume();
    if (usual * placement.molecule->atoms() > kMostAtoms)
      root_.fail("place", k, fmt::format("the box holds {:.3g} waters, more than taut takes", usual));
    State water;
    std::vector<Eigen::Index> there;
    for (double crowd = 1; crowd < 1.3; crowd += 0.05) {
      hear();
      water = cut(bulk, box_, std::lround(crowd * usual));
      there = placing.list_fitting(of(placement), water.x, 3);
      if (std::ssize(there) >= placement.count) break;
    }
    cut_to_fit_ = cut_to_fit_ || std::ssize(there) < water.x.cols() / 3;
    if (placement.fills) placement.count = std::max<long>(std::ssize(there), 1);
    if (std::ssize(there) < placement.count)
      root_.fail("place", k,
                 fmt::format("there is room for {} waters, not for {}: take a wider box", there.size(),
                             placement.count));
    drawn_ = drawn_ || std::ssize(there) > placement.count;
    hear();
    while (std::ssize(there) > placement.count)
      there.erase(there.begin() + static_cast<long>(random_.uniform() * static_cast<double>(there.size())));
    Vectors atoms(3, 3 * placement.count);
    for (long m = 0; m < placement.count; ++m)
      atoms.middleCols<3>(3 * m) = water.x.middleCols<3>(3 * there[m]);
    placing.add_copies(of(placement), atoms, 3);
    placement.x = water_model(placement.molecule->name)->placed(atoms);
  }

  // Without a region of its own a molecule is put between the walls.
  BoxRegion region_of(const Placement& placement) const {
    if (placement.within) return *placement.within;
    Vec3 lower = Vec3::Zero(), upper = within_.edge;
    for (int d = 0; d < 3; ++d) {
      Slab between{d, -kOpen, kOpen};
      for (const Slab& room : rooms_)
        if (room.axis == d)
          between = {d, std::max(between.lower, room.lower), std::min(between.upper, room.upper)};
      const bool above = between.lower > -kOpen, below = between.upper < kOpen;
      if (above) lower[d] = between.lower;
      if (below) upper[d] = between.upper;
      if (!(between.lower < between.upper))
        root_.fail("wall", fmt::format("the walls leave no room between them along {}", "xyz"[d]));
      if (!box_.periodic() && above && !below) upper[d] = lower[d] + within_.edge[d];
      if (!box_.periodic() && below && !above) lower[d] = upper[d] - within_.edge[d];
    }
    return {lower, upper - lower};
  }
  const Conformations& of(const Placement& placement) const { return conformations_.at(placement.molecule); }

  const TomlTable& root_;
  std::vector<Placement>& placements_;
  const Box box_;
  const bool may_overlap_;
  std::vector<Slab> rooms_;  // between walls
  Box within_;               // the region for copies, also for a scene without a box
  Random random_;
  std::map<const Molecule*, Conformations> conformations_;
  bool drawn_ = false, cut_to_fit_ = false;
};

// Sets the names of atoms and residues for files.
void set_names(const std::vector<Placement>& placements, Names& names) {
  std::map<AtomKind, int> known;
  for (const AtomKind& kind : names.kinds) known.try_emplace(kind, static_cast<int>(known.size()));
  int a = 0, residue = -1;
  for (const Placement& placement : placements) {
    const Names& given = placement.given.names;
    for (int k = 0, last = -1; k < static_cast<int>(placement.atoms()); ++k, ++a) {
      const int its = given.empty() ? names.residue[a] : given.residue[k];
      if (k == 0 || its != last) ++residue;
      last = its;
      names.residue[a] = residue;
      if (given.empty()) continue;
      AtomKind kind = given.kinds[given.kind[k]];
      if (kind.element.empty()) kind.element = names.kinds[names.kind[a]].element;
      const auto [at, fresh] = known.try_emplace(kind, static_cast<int>(names.kinds.size()));
      if (fresh) names.kinds.push_back(kind);
      names.kind[a] = at->second;
    }
  }
}

void assemble_placements(const std::vector<Placement>& placements, Scene& scene) {
  std::vector<Copies> copies;
  for (const Placement& placement : placements)
    copies.push_back({placement.molecule, static_cast<int>(placement.count)});
  assemble(copies, scene);
  set_names(placements, scene.names);
}

// Kremer and Grest's springs only pull: what keeps their beads apart is the pair force.
void note_springs_without_core(Scene& scene) {
  const Nonbonded& pairs = *scene.terms.nonbonded;
  std::set<std::pair<int, int>> left_out;
  for (const PairException& pair : pairs.exceptions)
    if (pair.epsilon == 0) left_out.insert(std::minmax(pair.i, pair.j));
  const auto without = std::ranges::count_if(scene.terms.fene, [&](const Fene& spring) {
    return pairs.epsilon[spring.i] * pairs.epsilon[spring.j] > 0 &&
           left_out.contains(std::minmax(spring.i, spring.j));
  });
  if (without > 0)
    scene.notes.push_back(fmt::format(
        "fene: nothing keeps the ends of {} springs apart, as exclude (\"1-3\" where it is not said) "
        "leaves their pair force out; Kremer and Grest's have exclude = \"none\"",
        without));
}

void read_forces(const BuildRequest& request, Scene& scene) {
  Terms& terms = scene.terms;
  const TomlTable& keys = request.forcefield;
  request.keys.read("gravity_nm_ps2", terms.gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
  if (!terms.nonbonded) return read_pair_table(request.root, scene);  // which refuses what it finds
  std::string pair = "lennard-jones";
  keys.read("pair", pair, {"the force between beads: purely repulsive, or not", {"wca", "lennard-jones"}});
  if (keys.describing()) return read_cutoff(keys, {}, *terms.nonbonded);
  if (!terms.fene.empty()) note_springs_without_core(scene);
  read_pair_table(request.root, scene);
  if (pair == "wca") make_repulsive(keys, terms);
  if (terms.nonbonded) read_cutoff(keys, scene.start.box, *terms.nonbonded);
}

void describe(const BuildRequest& request, Scene& scene) {
  const TomlTable atom = request.root.section("atom"), molecule = request.root.section("molecule");
  read_atom(atom.section("NAME"), "NAME");
  read_molecule(molecule.section("NAME"), "NAME", {});
  read_placement(request.root.section("place"), read_library(request.root));
  read_pair_table(request.root, scene);
  box_of(request.keys, {});
  scene.terms.nonbonded.emplace();
  read_forces(request, scene);
  read_named_start(request);
}

// The energy of all molecules but water alone.
double energy_without_water(const BuildRequest& request, const std::vector<Placement>& placements,
                            const Box& box) {
  Scene rest;
  std::vector<Copies> copies;
  std::vector<Vectors> places;
  Eigen::Index atoms = 0;
  for (const Placement& placement : placements) {
    if (placement.is_cut()) continue;
    copies.push_back({placement.molecule, static_cast<int>(placement.count)});
    places.push_back(placement.x);
    atoms += placement.x.cols();
  }
  if (atoms == 0) return 0;
  assemble(copies, rest);
  rest.start.box = box;
  rest.start.x.resize(3, atoms);
  atoms = 0;
  for (const Vectors& x : places) {
    rest.start.x.middleCols(atoms, x.cols()) = x;
    atoms += x.cols();
  }
  read_forces(request, rest);
  ForceField forces(rest.system, box, rest.terms);
  return forces.evaluate_energy(rest.system, rest.start);
}

// Relaxes water that was cut to fit among other molecules until it has the energy of equilibrated water, with all
// other atoms at rest. Returns whether that was reached.
bool settle_water(const BuildRequest& request, const std::vector<Placement>& placements, Scene& scene) {
  const State bulk = equilibrated_water(read_start(scenes_folder() / "water216.start.toml"),
                                        scene.terms.nonbonded->cutoff.value_or(0));
  double energy = energy_without_water(request, placements, scene.start.box);
  std::vector<RigidMolecules> waters;
  Eigen::Index first = 0;
  for (const Placement& placement : placements) {
    const Eigen::Index last = first + placement.x.cols();
    if (placement.is_cut()) {
      const WaterModel* model = water_model(placement.molecule->name);
      waters.push_back({first, last, model->atoms()});
      energy +=
          static_cast<double>(placement.count) * energy_of_equilibrated(*model, bulk, request.forcefield);
    }
    first = last;
  }
  ForceField forces(scene.system, scene.start.box, scene.terms);
  return relax(scene.system, forces, waters, energy, scene.start);
}

// The box that a run of the scene has reached, where an override names its start; and where the scene gives a density,
// which does not determine the shape of a box.
Box box_of_start(const TomlTable& keys, const Box& of_start, const Box& of_scene) {
  if (!of_start.periodic() || !of_scene.periodic()) return of_scene;
  const bool as_dense = !keys.has("box_nm") && std::abs(of_start.volume() / of_scene.volume() - 1) < 1e-9;
  return keys.overridden("start") || as_dense ? of_start : of_scene;
}

// As many waters as the start has beside the other molecules.
void count_filling_water(Eigen::Index atoms, std::vector<Placement>& placements) {
  const auto filling = std::ranges::find_if(placements, &Placement::fills);
  if (filling == placements.end()) return;
  for (const Placement& placement : placements) atoms -= static_cast<Eigen::Index>(placement.atoms());
  filling->count = std::max<long>(atoms / filling->molecule->atoms(), 0);
}

// Goes on from the end of a run of the same scene, for which nothing is placed. Returns whether it fits.
bool go_on_from(State start, const BuildRequest& request, std::vector<Placement> placements, Scene& scene) {
  Scene same = scene;
  same.start.box = box_of_start(request.keys, start.box, scene.start.box);
  count_filling_water(start.x.cols(), placements);
  assemble_placements(placements, same);
  if (!take_start(request, std::move(start), same)) {
    scene.notes = std::move(same.notes);
    return false;
  }
  read_forces(request, same);
  scene = std::move(same);
  return true;
}

void note_start(const BuildRequest& request, const Builder& built, bool settled, Scene& scene) {
  if (!(built.drawn() || built.cut_to_fit()) || request.run.minimise) return;
  if (built.drawn() && !request.run.thermostatted())
    scene.notes.emplace_back("start: molecules where there was room; equilibrate with run.thermostat_ps");
  if (!settled)
    scene.notes.emplace_back(
        "start: water cut to fit does not settle to the energy of equilibrated water here: it heats up; "
        "run.minimise = true relaxes it further");
  ForceField forces(scene.system, scene.start.box, scene.terms);
  State s = scene.start;
  s.f = Vectors::Zero(3, s.x.cols());
  try {
    forces.evaluate(scene.system, s);
  } catch (const SimulationFailure&) {
    return;  // below a table: refused once the whole scene is read
  }
  Eigen::Index atom = 0;
  const double largest = std::sqrt(s.f.colwise().squaredNorm().maxCoeff(&atom));
  if (!(largest < kStrongForce))
    scene.notes.push_back(
        fmt::format("start: a force of {:.2g} kJ/mol/nm acts on atom {}: it heats up, or breaks; "
                    "run.minimise = true relaxes it",
                    largest, atom));
}

}  // namespace

// kind = "molecules": [[place]]s of [molecule.NAME]s, with the keys of read_cutoff.
void build_molecules(const BuildRequest& request, Scene& scene) {
  if (request.keys.describing()) return describe(request, scene);
  request.keys.refuse({"molecules", "chains"}, "copies are counted where they are placed: place.0.count");
  const Library library = read_library(request.root);
  std::vector<Placement> placements = read_placements(request.root, library);
  scene.start.box = box_of(request.keys, placements);
  if (auto start = read_named_start(request);
      start && go_on_from(std::move(*start), request, placements, scene))
    return;
  const Builder built(request, placements, scene.start.box);

  hear();
  assemble_placements(placements, scene);
  hear();
  scene.start.x.resize(3, scene.system.atoms());
  scene.start.v = Vectors::Zero(3, scene.system.atoms());
  Eigen::Index first = 0;
  bool moving = true, some_move = false;
  for (const Placement& placement : placements) {
    scene.start.x.middleCols(first, placement.x.cols()) = placement.x;
    moving = moving && placement.given.v.cols() > 0;
    some_move = some_move || placement.given.v.cols() > 0;
    if (moving) scene.start.v.middleCols(first, placement.x.cols()) = placement.given.v;
    first += placement.x.cols();
  }
  if (!moving) scene.start.v.setZero();  // otherwise some have velocities
  if (some_move && !moving)
    scene.notes.emplace_back("start: velocities of files are left out, as some molecules have none");
  place_sites(scene.system.sites, scene.start.x);
  read_forces(request, scene);
  scene.positions_drawn = built.drawn();
  const bool settled = !built.cut_to_fit() || settle_water(request, placements, scene);
  for (const Placement& placement : placements)
    if (!placement.given.note.empty()) scene.notes.push_back("start: " + placement.given.note);
  note_start(request, built, settled, scene);
}

}  // namespace taut
