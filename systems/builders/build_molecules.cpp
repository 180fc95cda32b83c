#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "forcefield/force_field.hpp"
#include "md/units.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/builders/places.hpp"
#include "systems/builders/solvent.hpp"
#include "systems/molecules/placing.hpp"
#include "systems/scene_file.hpp"
#include "systems/start_file.hpp"

namespace taut {
namespace {

constexpr double kUsualKelvin = 300;     // torsions are drawn at, if nothing is said
constexpr double kStrongForce = 20'000;  // on one atom: some ten times what liquids have [kJ/mol/nm]

// Places all copies: those that have no choice first, water last.
class Builder {
 public:
  Builder(const BuildRequest& request, std::vector<Place>& places, const Box& box)
      : root_(request.root), places_(places), box_(box), random_(request.run.seed) {
    const double kelvin = request.run.temperature_k > 0 ? request.run.temperature_k : kUsualKelvin;
    double widest = 0, room = 0;
    for (const Place& place : places) {
      if (!conformations_.contains(place.molecule)) try {
          conformations_.try_emplace(place.molecule, *place.molecule, kBoltzmann * kelvin);
        } catch (const InputError& e) {
          root_.section("molecule").fail(place.molecule->name, e.what());
        }
      const Conformations& conformations = conformations_.at(place.molecule);
      widest = std::max(widest, conformations.widest());
      room += static_cast<double>(place.count) * std::pow(conformations.extent(), 3);
    }
    within_ = box.periodic() ? box : Box{Vec3::Constant(std::max(std::cbrt(room), 1e-6))};
    Placing placing(box, widest, random_);
    for (const auto& step :
         {&Builder::give, &Builder::line_up, &Builder::centre, &Builder::draw, &Builder::fill})
      for (std::size_t k = 0; k < places.size(); ++k)
        if (places[k].x.cols() == 0) (this->*step)(k, placing);
  }

  bool drawn() const { return drawn_; }
  bool cut_to_fit() const { return cut_to_fit_; }  // water, among other molecules

 private:
  void give(std::size_t k, Placing& placing) {
    Place& place = places_[k];
    if (place.given.x.cols() == 0) return;
    place.x = place.given.x;
    placing.take(of(place), place.x);
  }

  void centre(std::size_t k, Placing& placing) {
    Place& place = places_[k];
    if (place.centres.cols() == 0) return;
    put(k, placing, [&](long m) { return Vec3(place.centres.col(m)); });
  }

  void line_up(std::size_t k, Placing& placing) {
    if (!places_[k].lattice) return;
    const Brick brick = brick_of(places_[k]);
    const BrickGrid grid(brick.edge, places_[k].count);
    put(k, placing, [&](long m) { return Vec3(brick.corner + grid.site(m)); });
  }

  void draw(std::size_t k, Placing& placing) {
    if (places_[k].fills || (places_[k].equilibrated && box_.periodic())) return;
    const Brick brick = brick_of(places_[k]);
    put(k, placing, [&](long) {
      const Vec3 share(random_.uniform(), random_.uniform(), random_.uniform());
      return places_[k].within ? Vec3(brick.corner + share.cwiseProduct(brick.edge))
                               : within_.lattice_vector(share);
    });
  }

  template <class Where>
  void put(std::size_t k, Placing& placing, Where where) {
    Place& place = places_[k];
    drawn_ = true;
    const int each = place.molecule->atoms();
    place.x.resize(3, each * place.count);
    for (long m = 0; m < place.count; ++m) {
      const auto copy = placing.put(of(place), [&] { return where(m); });
      if (!copy)
        root_.fail("place", k,
                   fmt::format("there is no room for copy {} of {} of \"{}\": take fewer, or a wider box",
                               m + 1, place.count, place.molecule->name));
      place.x.middleCols(m * each, each) = *copy;
    }
  }

  // Cut more and more densely, where as many as are asked for do not fit.
  void fill(std::size_t k, Placing& placing) {
    Place& place = places_[k];
    if (!box_.periodic())
      root_.fail("place", k, "water without a count fills a box: say build.box_nm, or a count");
    const State bulk = read_start(scenes_folder() / "water216.start.toml");
    const double usual = static_cast<double>(bulk.x.cols()) / 3 / bulk.box.volume() * box_.volume();
    if (usual * place.molecule->atoms() > kMostAtoms)
      root_.fail("place", k, fmt::format("the box holds {:.3g} waters, more than taut takes", usual));
    State water;
    std::vector<Eigen::Index> there;
    for (double crowd = 1; crowd < 1.3; crowd += 0.05) {
      water = cut(bulk, box_, std::lround(crowd * usual));
      there = placing.fitting(of(place), water.x, 3);
      if (std::ssize(there) >= place.count) break;
    }
    cut_to_fit_ = cut_to_fit_ || std::ssize(there) < water.x.cols() / 3;
    if (place.fills) place.count = std::max<long>(std::ssize(there), 1);
    if (std::ssize(there) < place.count)
      root_.fail("place", k,
                 fmt::format("there is room for {} waters, not for {}: take a wider box", there.size(),
                             place.count));
    drawn_ = drawn_ || std::ssize(there) > place.count;
    while (std::ssize(there) > place.count)
      there.erase(there.begin() + static_cast<long>(random_.uniform() * static_cast<double>(there.size())));
    Vectors atoms(3, 3 * place.count);
    for (long m = 0; m < place.count; ++m) atoms.middleCols<3>(3 * m) = water.x.middleCols<3>(3 * there[m]);
    placing.take(of(place), atoms, 3);
    place.x = water_model(place.molecule->name)->placed(atoms);
  }

  Brick brick_of(const Place& place) const {
    return place.within.value_or(Brick{Vec3::Zero(), within_.edge});
  }
  const Conformations& of(const Place& place) const { return conformations_.at(place.molecule); }

  const TomlTable& root_;
  std::vector<Place>& places_;
  const Box box_;
  Box within_;  // where copies are put; it is no box of the scene's where there is none
  Random random_;
  std::map<const Molecule*, Conformations> conformations_;
  bool drawn_ = false, cut_to_fit_ = false;
};

// Atoms and residues as files call them.
void take_names(const std::vector<Place>& places, Names& names) {
  std::map<AtomKind, int> known;
  for (const AtomKind& kind : names.kinds) known.try_emplace(kind, static_cast<int>(known.size()));
  int a = 0, residue = -1;
  for (const Place& place : places) {
    const Names& given = place.given.names;
    for (int k = 0, last = -1; k < place.x.cols(); ++k, ++a) {
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

// Repulsive beads are of one kind, and their pair force acts or does not.
void make_repulsive(const TomlTable& keys, Terms& terms) {
  Nonbonded& pairs = *terms.nonbonded;
  const double sigma = pairs.sigma[0], epsilon = pairs.epsilon[0];
  for (Eigen::Index a = 0; a < pairs.sigma.size(); ++a)
    if (pairs.sigma[a] != sigma || pairs.epsilon[a] != epsilon || epsilon == 0)
      keys.fail("pair",
                fmt::format("wca takes one sigma_nm and one epsilon_kj_mol for all atoms; atoms 0 and {} "
                            "differ, or have none",
                            a));
  Wca& wca = terms.wca.emplace(Wca{sigma, epsilon, {}});
  for (PairException& pair : pairs.exceptions) {
    if (pair.epsilon != 0 && pair.epsilon != epsilon)
      keys.fail("pair", "of wca pairs three bonds apart have all or nothing: lennard_jones_14 = 0 or 1");
    if (pair.epsilon == 0) wca.exclusions.push_back({pair.i, pair.j});
    pair.epsilon = 0;
  }
  pairs.epsilon.setZero();
  if (pairs.charge.isZero(0)) terms.nonbonded.reset();
}

void read_forces(const BuildRequest& request, Scene& scene) {
  Terms& terms = scene.terms;
  const TomlTable& keys = request.forcefield;
  request.keys.read("gravity_nm_ps2", terms.gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
  if (!terms.nonbonded) return;
  std::string pair = "lennard-jones";
  keys.read("pair", pair, {"the force between beads: purely repulsive, or not", {"wca", "lennard-jones"}});
  if (keys.describing()) return read_cutoff(keys, {}, *terms.nonbonded);
  if (pair == "wca") make_repulsive(keys, terms);
  if (terms.nonbonded) read_cutoff(keys, scene.start.box, *terms.nonbonded);
}

void describe(const BuildRequest& request, Scene& scene) {
  const TomlTable atom = request.root.section("atom"), molecule = request.root.section("molecule");
  read_atom(atom.section("NAME"), "NAME");
  read_molecule(molecule.section("NAME"), "NAME", {});
  read_place(request.root.section("place"), read_library(request.root));
  box_of(request.keys, {});
  scene.terms.nonbonded.emplace();
  read_forces(request, scene);
}

void note_start(const BuildRequest& request, const Builder& built, Scene& scene) {
  if (!(built.drawn() || built.cut_to_fit()) || request.run.minimise) return;
  if (built.drawn() && !request.run.thermostatted())
    scene.notes.emplace_back("start: molecules where there was room; equilibrate with run.thermostat_ps");
  if (built.cut_to_fit())
    scene.notes.emplace_back(
        "start: water cut to fit settles, which heats it by some 70 K within 0.2 ps; by 20 K after "
        "run.minimise = true");
  ForceField forces(scene.system, scene.start.box, scene.terms);
  State s = scene.start;
  s.f = Vectors::Zero(3, s.x.cols());
  forces.evaluate(scene.system, s);
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
  std::vector<Place> places = read_places(request.root, library);
  scene.start.box = box_of(request.keys, places);
  const Builder built(request, places, scene.start.box);

  std::vector<Copies> copies;
  Eigen::Index atoms = 0;
  for (const Place& place : places) {
    copies.push_back({place.molecule, static_cast<int>(place.count)});
    atoms += place.x.cols();
  }
  put_together(copies, scene);
  take_names(places, scene.names);
  scene.start.x.resize(3, atoms);
  scene.start.v = Vectors::Zero(3, atoms);
  Eigen::Index first = 0;
  bool moving = true;
  for (const Place& place : places) {
    scene.start.x.middleCols(first, place.x.cols()) = place.x;
    moving = moving && place.given.v.cols() > 0;
    if (moving) scene.start.v.middleCols(first, place.x.cols()) = place.given.v;
    first += place.x.cols();
  }
  if (!moving) scene.start.v.setZero();  // some have velocities, or none
  place_sites(scene.system.sites, scene.start.x);
  read_forces(request, scene);
  scene.positions_drawn = built.drawn();
  for (const Place& place : places)
    if (!place.given.note.empty()) scene.notes.push_back("start: " + place.given.note);
  note_start(request, built, scene);
}

}  // namespace taut
