#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/listen.hpp"
#include "base/random.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/builders/solvent.hpp"
#include "systems/builders/water_models.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

const WaterModel& chosen_model(const TomlTable& keys) {
  std::vector<std::string_view> names;
  for (const WaterModel& model : water_models()) names.push_back(model.name);
  return *water_model(keys.choice("model", names, "the water"));
}

// Inserts the model's sites after the atoms of each molecule.
Vectors with_sites(const WaterModel& model, const Vectors& atoms) {
  const Eigen::Index molecules = atoms.cols() / 3;
  Vectors all = Vectors::Zero(3, model.atoms() * molecules);
  for (Eigen::Index m = 0; m < molecules; ++m)
    all.middleCols<3>(model.atoms() * m) = atoms.middleCols<3>(3 * m);
  return all;
}

// Places waters on a grid, in random orientations, at rest.
State lattice_of_water(const WaterModel& model, long molecules, const Box& box, Random& random) {
  State start;
  start.box = box;
  start.x.resize(3, 3 * molecules);
  start.v = Vectors::Zero(3, 3 * molecules);
  const RegionGrid grid(box.edge, molecules);
  for (long m = 0; m < molecules; ++m) {
    const Vec3 o = grid.site(m);
    start.x.col(3 * m) = o;
    start.x.col(3 * m + 1) = o + random.unit_vector();
    start.x.col(3 * m + 2) = o + random.unit_vector();
    model.set_geometry(start.x.middleCols(3 * m, 3));
  }
  return start;
}

// Returns the molecules nearest to the middle, without the box.
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

// Returns the edge of the cube from which a droplet is cut: its diameter and the width of a molecule.
double droplet_edge(long molecules, double density) {
  return 2 * std::cbrt(0.75 * static_cast<double>(molecules) / density / std::numbers::pi) + 0.3;
}

// Builds water from the scene's start, or on a lattice.
class WaterSource {
 public:
  WaterSource(const BuildRequest& request, const WaterModel& model)
      : keys_(request.keys), model_(model), random_(request.run.seed) {
    std::filesystem::path file;
    std::optional<double> density;
    if (keys_.read("start", file,
                   "equilibrated waters of any model in a box, of which n³ times as many are tiled, and any "
                   "other number and droplets cut; or a droplet, for one of as many"))
      start_ = read_start(file);
    keys_.read("density_g_cm3", density,
               {"of a lattice of molecules; required without a start", "g/cm³", kPositive});
    unit_ = read_box_shape(keys_);
    if (keys_.describing()) return;
    if (!start_) {
      density_ = (density ? *density : keys_.get<double>("density_g_cm3")) * kGramPerCm3 / model.mass();
      return;
    }
    if (!remove_sites(*start_)) keys_.fail("start", "expected waters: O, H, H, ...");
    if (keys_.has("density_g_cm3")) keys_.fail("density_g_cm3", "build.start has a density of its own");
    density_ = static_cast<double>(molecules_of_start()) / start_->box.volume();
  }

  State box_of(long molecules, std::vector<std::string>& notes) {
    const auto count = static_cast<double>(molecules);
    if (!start_) {
      const Box box = unit_.scaled(Vec3::Constant(std::cbrt(count / density_ / unit_.volume())));
      notes.emplace_back(
          "start: molecules on a lattice, turned at random, heat up by hundreds of kelvin: equilibrate with "
          "run.thermostat_ps, or set out from equilibrated water, build.start");
      drawn_ = true;
      return lattice_of_water(model_, molecules, box, random_);
    }
    require_box();
    const bool same_shape =
        !keys_.has("box") || start_->box.vectors().isApprox(start_->box.edge.x() * unit_.vectors(), 1e-6);
    const int n = static_cast<int>(std::lround(std::cbrt(count / static_cast<double>(molecules_of_start()))));
    if (same_shape && n * n * n * molecules_of_start() == molecules) return tiled(*start_, n);
    const Box shape = keys_.has("box") ? unit_ : start_->box;
    is_cut_ = true;
    return cut(*start_, shape.scaled(Vec3::Constant(std::cbrt(count / density_ / shape.volume()))),
               molecules);
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
  bool is_cut() const { return is_cut_; }  // whether some molecules have new neighbours

  // Equilibrated water in a box large enough for the cutoff.
  State bulk(double cutoff) const { return equilibrated_water(*start_, cutoff); }

 private:
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
  Box unit_;        // the requested shape
  double density_;  // [molecules/nm³]
  bool drawn_ = false, is_cut_ = false;
};

// Returns molecules of the model at the positions of these waters.
void fill(const WaterModel& model, const State& waters, Scene& scene) {
  const Molecule molecule = model.molecule();
  assemble({{&molecule, static_cast<int>(waters.x.cols() / 3)}}, scene);
  scene.start.box = waters.box;
  scene.start.v = with_sites(model, waters.v);
  scene.start.x = model.placed(waters.x);
}

}  // namespace

double energy_of_equilibrated(const WaterModel& model, const State& waters, const TomlTable& forcefield) {
  Scene bulk;
  fill(model, waters, bulk);
  read_cutoff(forcefield, bulk.start.box, *bulk.terms.nonbonded);
  ForceField forces(bulk.system, bulk.start.box, bulk.terms);
  bulk.start.f = Vectors::Zero(3, bulk.system.atoms());
  return forces.evaluate_energy(bulk.system, bulk.start) * model.atoms() / bulk.system.atoms();
}

State equilibrated_water(const State& unit, double cutoff) {
  return tiled(unit, static_cast<int>(std::ceil(std::max(1.0, 2 * cutoff / unit.box.edge.minCoeff()))));
}

namespace {

// Minimises down to the energy per molecule of the equilibrated start.
void settle(const BuildRequest& request, const WaterModel& model, const WaterSource& source, Scene& scene) {
  const double each = energy_of_equilibrated(model, source.bulk(scene.terms.nonbonded->cutoff.value_or(0)),
                                             request.forcefield);
  ForceField forces(scene.system, scene.start.box, scene.terms);
  const RigidMolecules waters{0, scene.system.atoms(), model.atoms()};
  if (!relax(scene.system, forces, {waters}, each * static_cast<double>(waters.count()), scene.start))
    scene.notes.emplace_back(
        "start: cut from equilibrated water, whose faces do not settle here: it heats up; run.minimise = "
        "true");
}

}  // namespace

// kind = "water": rigid water of three to five sites, with the keys of read_cutoff. If the start is of
// another model, O stays, and H and the sites move to the places of this model.
void build_water(const BuildRequest& request, Scene& scene) {
  const TomlTable& keys = request.keys;
  const WaterModel& model = chosen_model(keys);
  const auto molecules = keys.get<long>("molecules", {"how many", Range{.min = 1}});
  atoms_of(keys, "molecules", static_cast<double>(molecules), model.atoms());
  const bool box = keys.choice("shape", {"box", "droplet"}, "a droplet has no box") == "box";
  WaterSource source(request, model);
  keys.require_effect("box", box, "with build.shape = \"box\"");
  if (keys.describing()) return read_cutoff(request.forcefield, {}, scene.terms.nonbonded.emplace());
  const State waters =
      box ? source.box_of(molecules, scene.notes) : source.droplet_of(molecules, scene.notes);
  hear();
  fill(model, waters, scene);
  hear();
  read_cutoff(request.forcefield, scene.start.box, *scene.terms.nonbonded);
  scene.positions_drawn = source.drawn();
  if (source.is_cut()) settle(request, model, source, scene);
}

}  // namespace taut
