#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "md/random.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/builders/water_models.hpp"
#include "systems/start_file.hpp"

namespace taut {
namespace {

const WaterModel& chosen_model(const TomlTable& keys) {
  std::vector<std::string_view> names;
  for (const WaterModel& model : water_models()) names.push_back(model.name);
  const std::string name = keys.choice("model", names, "the water");
  return *std::ranges::find(water_models(), name, &WaterModel::name);
}

// Leaves O, H, H of each molecule; the sites of other models stand behind them, nearer than the next O.
// False where there are none.
bool keep_atoms(Vectors& x, Vectors& v) {
  constexpr double kNearest = 0.2;  // two O are further apart [nm]
  Eigen::Index each = 0;
  while (each < x.cols() && (x.col(each) - x.col(0)).norm() < kNearest) ++each;
  if (each < 3 || x.cols() % each != 0) return false;
  const Eigen::Index molecules = x.cols() / each;
  for (Vectors* of : {&x, &v}) {
    for (Eigen::Index m = 0; m < molecules; ++m)
      of->middleCols<3>(3 * m) = of->middleCols<3>(each * m).eval();
    of->conservativeResize(3, 3 * molecules);
  }
  return true;
}

// Room for the model's sites behind the atoms of each molecule.
Vectors with_sites(const WaterModel& model, const Vectors& atoms) {
  const Eigen::Index molecules = atoms.cols() / 3;
  Vectors all = Vectors::Zero(3, model.atoms() * molecules);
  for (Eigen::Index m = 0; m < molecules; ++m)
    all.middleCols<3>(model.atoms() * m) = atoms.middleCols<3>(3 * m);
  return all;
}

// The shapes of a box, of a first vector of 1, by the cell of points nearest to one of the lattice. Of the
// same width, a truncated octahedron takes 0.77 and a rhombic dodecahedron 0.71 of a cube's water.
Box unit_box(const std::string& shape) {
  if (shape == "octahedron")
    return {Vec3(1, std::sqrt(8.0) / 3, std::sqrt(6.0) / 3), Vec3(1, -1, std::sqrt(2.0)) / 3};
  if (shape == "dodecahedron") return {Vec3(1, 1, std::sqrt(0.5)), Vec3(0, 0.5, 0.5)};
  return {Vec3::Ones()};
}

// On a grid in the box's brick, empty sites spread evenly, turned at random, at rest.
State lattice_of_water(const WaterModel& model, long molecules, const Box& box, Random& random) {
  State start;
  start.box = box;
  start.x.resize(3, 3 * molecules);
  start.v = Vectors::Zero(3, 3 * molecules);
  const double apart = std::cbrt(box.volume() / static_cast<double>(molecules));
  const Eigen::Matrix<long, 3, 1> n = (box.edge.array() / apart - 1e-9).ceil().cast<long>();
  for (long m = 0; m < molecules; ++m) {
    const long site = m * n.prod() / molecules;
    const Eigen::Array3d cell =
        Eigen::Array<long, 3, 1>(site % n[0], site / n[0] % n[1], site / n[0] / n[1]).cast<double>();
    const Vec3 o = box.edge.array() / n.cast<double>().array() * (cell + 0.5);
    start.x.col(3 * m) = o;
    start.x.col(3 * m + 1) = o + random.unit_vector();
    start.x.col(3 * m + 2) = o + random.unit_vector();
    model.set_geometry(start.x.middleCols(3 * m, 3));
  }
  return start;
}

// The start side by side with itself, n times along each edge, every O in its own image of the box.
State tiled(const State& unit, int n) {
  const Eigen::Index atoms = unit.x.cols();
  Vectors home = unit.x;
  for (Eigen::Index o = 0; o < atoms; o += 3) {
    home.middleCols(o, 3).colwise() -= unit.box.steps(unit.box.bricks(unit.x.col(o), std::floor));
  }
  State all;
  all.box = unit.box.scaled(Vec3::Constant(n));
  all.x.resize(3, atoms * n * n * n);
  all.v = unit.v.replicate(1, n * n * n);
  for (int t = 0; t < n * n * n; ++t)
    all.x.middleCols(t * atoms, atoms) = home.colwise() + unit.box.steps(cube_cell(t, n));
  return all;
}

// The molecules nearest the middle, without the box.
State droplet(const State& bulk, long molecules) {
  std::vector<Eigen::Index> order(bulk.x.cols() / 3);
  std::iota(order.begin(), order.end(), 0);
  const Vec3 middle = bulk.box.edge / 2;
  std::ranges::stable_sort(order, {},
                           [&](Eigen::Index m) { return (bulk.x.col(3 * m) - middle).squaredNorm(); });
  State drop;
  drop.x.resize(3, 3 * molecules);
  drop.v.resize(3, 3 * molecules);
  for (long m = 0; m < molecules; ++m) {
    drop.x.middleCols(3 * m, 3) = bulk.x.middleCols(3 * order[m], 3);
    drop.v.middleCols(3 * m, 3) = bulk.v.middleCols(3 * order[m], 3);
  }
  return drop;
}

// How much water a droplet is cut from: a cube around its sphere, and a molecule's width to spare.
double droplet_edge(long molecules, double density) {
  return 2 * std::cbrt(0.75 * static_cast<double>(molecules) / density / std::numbers::pi) + 0.3;
}

// Water from the scene's start, or on a lattice.
class WaterSource {
 public:
  WaterSource(const BuildRequest& request, const WaterModel& model)
      : keys_(request.keys), model_(model), random_(request.run.seed) {
    std::filesystem::path file;
    std::optional<double> density;
    if (keys_.read("start", file,
                   "equilibrated waters of any model in a box, from which n³ times as many are tiled and "
                   "droplets cut "
                   "(any other number stands on a lattice); or a droplet, for one of as many"))
      start_ = read_start(file);
    keys_.read("density_g_cm3", density,
               {"of a lattice of molecules; required without a start", "g/cm³", kPositive});
    keys_.read("box", shape_, {"shape of the box", {"cube", "octahedron", "dodecahedron"}});
    if (keys_.describing()) return;
    if (!start_) {
      density_ = (density ? *density : keys_.get<double>("density_g_cm3")) * kGramPerCm3 / model.mass();
      return;
    }
    if (!keep_atoms(start_->x, start_->v)) keys_.fail("start", "expected waters: O, H, H, ...");
    if (keys_.has("density_g_cm3")) keys_.fail("density_g_cm3", "build.start has a density of its own");
    density_ = static_cast<double>(molecules_of_start()) / start_->box.volume();
  }

  State box_of(long molecules, std::vector<std::string>& notes) {
    const Box unit = unit_box(shape_);
    if (start_) {
      require_box();
      const double times = static_cast<double>(molecules) / static_cast<double>(molecules_of_start());
      const int n = static_cast<int>(std::lround(std::cbrt(times)));
      if (keys_.has("box") && !start_->box.vectors().isApprox(start_->box.edge.x() * unit.vectors(), 1e-6)) {
        if (keys_.overridden("start")) keys_.fail("start", "its box is of another shape than build.box");
        notes.emplace_back("start: the equilibrated start's box is of another shape");
        return drawn_in(unit, molecules, notes);
      }
      if (n * n * n * molecules_of_start() == molecules) return tiled(*start_, n);
      if (keys_.overridden("start"))
        keys_.fail("start", fmt::format("{} molecules are not n³ times the {} it has", molecules,
                                        molecules_of_start()));
      notes.push_back(fmt::format("start: {} molecules are not n³ times the {} of the equilibrated start",
                                  molecules, molecules_of_start()));
    }
    return drawn_in(unit, molecules, notes);
  }

  State droplet_of(long molecules, std::vector<std::string>& notes) {
    if (start_ && !start_->box.periodic() && molecules_of_start() == molecules) return *start_;
    if (start_) require_box();
    if (start_ && !start_->box.tilt.isZero(0)) keys_.fail("start", "a droplet is cut from a rectangular box");
    const double edge = droplet_edge(molecules, density_);
    const double n = std::ceil(start_ ? edge / start_->box.edge.minCoeff() : edge * std::cbrt(density_));
    atoms_of(keys_, start_ ? "start" : "density_g_cm3", n * n * n,
             start_ ? static_cast<double>(start_->x.cols()) : 3.0);
    if (start_) return droplet(tiled(*start_, static_cast<int>(n)), molecules);
    return droplet(box_of(static_cast<long>(n * n * n), notes), molecules);
  }

  bool drawn() const { return drawn_; }

 private:
  State drawn_in(const Box& unit, long molecules, std::vector<std::string>& notes) {
    notes.emplace_back("start: molecules on a lattice, turned at random; equilibrate with run.thermostat_ps");
    drawn_ = true;
    const double edge = std::cbrt(static_cast<double>(molecules) / density_ / unit.volume());
    return lattice_of_water(model_, molecules, unit.scaled(Vec3::Constant(edge)), random_);
  }

  long molecules_of_start() const { return start_->x.cols() / 3; }
  void require_box() const {
    if (!start_->box.periodic())
      keys_.fail("start", fmt::format("a droplet of {}, which serves for a droplet of as many alone",
                                      molecules_of_start()));
  }

  const TomlTable& keys_;
  const WaterModel& model_;
  Random random_;
  std::optional<State> start_;
  std::string shape_ = "cube";
  double density_;  // [molecules/nm³]
  bool drawn_ = false;
};

void add_molecule(const WaterModel& model, int o, Nonbonded& pairs, std::vector<RigidBond>& bonds) {
  const int h1 = o + 1, h2 = o + 2, end = o + model.atoms();
  for (int a = o; a < end; ++a) {
    pairs.charge[a] = a == o ? model.charge_o() : a <= h2 ? model.charge_h : model.charge_of_site();
    pairs.sigma[a] = a == o ? model.sigma : 1;  // of no account where ε is 0
    pairs.epsilon[a] = a == o ? model.epsilon : 0;
    for (int b = a + 1; b < end; ++b) pairs.exceptions.push_back({a, b, 0, 1, 0});
  }
  bonds.push_back({o, h1, model.oh});
  bonds.push_back({o, h2, model.oh});
  bonds.push_back({h1, h2, model.hh()});
}

Names names_of(const WaterModel& model, int molecules) {
  std::vector<AtomKind> atoms = {{"OW", "HOH", "O"}, {"HW1", "HOH", "H"}, {"HW2", "HOH", "H"}};
  if (model.sites == 1) atoms.push_back({"MW", "HOH", ""});
  if (model.sites == 2) atoms.insert(atoms.end(), {{"LP1", "HOH", ""}, {"LP2", "HOH", ""}});
  return repeated_names(atoms, molecules);
}

}  // namespace

// kind = "water": rigid water, of three to five sites, with the keys of read_cutoff. Of a start of another
// model O stays; H and sites move to the model's places.
void build_water(const BuildRequest& request, Scene& scene) {
  const TomlTable& keys = request.keys;
  const WaterModel& model = chosen_model(keys);
  const auto molecules = keys.get<long>("molecules", {"how many", Range{.min = 1}});
  const int each = model.atoms(), atoms = atoms_of(keys, "molecules", static_cast<double>(molecules), each);
  const bool box = keys.choice("shape", {"box", "droplet"}, "a droplet has no box") == "box";
  WaterSource source(request, model);
  keys.counts("box", box, "with build.shape = \"box\"");
  if (keys.describing()) return read_cutoff(request.forcefield, {}, scene.terms.nonbonded.emplace());
  const State start = box ? source.box_of(molecules, scene.notes) : source.droplet_of(molecules, scene.notes);
  scene.start.box = start.box;
  Vectors& x = scene.start.x = with_sites(model, start.x);
  scene.start.v = with_sites(model, start.v);

  Nonbonded& pairs = scene.terms.nonbonded.emplace();
  pairs.charge.resize(atoms);
  pairs.sigma.resize(atoms);
  pairs.epsilon.resize(atoms);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(atoms);
  std::vector<RigidBond> bonds;
  VirtualSites sites;
  for (int o = 0; o < atoms; o += each) {
    model.set_geometry(x.middleCols(o, 3));
    mass.segment<3>(o) << model.mass_o, model.mass_h, model.mass_h;
    add_molecule(model, o, pairs, bonds);
    for (VirtualSite& site : model.sites_of(o)) sites.push_back(std::move(site));
  }
  place_sites(sites, x);
  scene.names = names_of(model, atoms / each);
  read_cutoff(request.forcefield, start.box, pairs);
  scene.positions_drawn = source.drawn();
  scene.system = make_system(std::move(mass), std::move(bonds), std::move(sites));
}

}  // namespace taut
