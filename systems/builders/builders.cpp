#include "systems/builders/builders.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "forcefield/pme/parameters.hpp"
#include "md/errors.hpp"
#include "md/observables.hpp"
#include "systems/start_file.hpp"
#include "systems/whole_molecules.hpp"

namespace taut {
namespace {

constexpr double kMostAtoms = 5e6;  // about 2 GB of arrays and lists

struct Kind {
  std::string_view name;
  void (*build)(const BuildRequest&, Scene&);
  bool own_start = false;  // reads build.start itself
};
constexpr std::array kKinds = {Kind{"atoms", build_atoms},   Kind{"chains", build_chains},
                               Kind{"rings", build_rings},   Kind{"melt", build_melt},
                               Kind{"alkane", build_alkane}, Kind{"water", build_water, true}};

const Kind& chosen_kind(const TomlTable& keys) {
  std::vector<std::string_view> names(kKinds.size());
  std::ranges::transform(kKinds, names.begin(), &Kind::name);
  const std::string name = keys.choice("kind", names);
  return *std::ranges::find(kKinds, name, &Kind::name);
}

// What keeps a start from being one of this scene; null: nothing.
const char* misfit(const State& start, const Scene& scene) {
  const Vectors& x = start.x;
  if (x.cols() != scene.system.atoms()) return "another number of atoms";
  if (!start.box.vectors().isApprox(scene.start.box.vectors(), 1e-9)) return "another box";
  if (bond_errors(scene.system, x).max > 0.01) return "other bonds";
  for (const Fene& spring : scene.terms.fene)
    if ((x.col(spring.j) - x.col(spring.i)).norm() >= spring.r0) return "other springs";
  return nullptr;
}

// The last state of a run of the same scene in place of the built one.
void lay_start(const BuildRequest& request, Scene& scene) {
  std::filesystem::path file;
  if (!request.keys.read("start", file)) return;
  State start = read_start(file);
  if (const char* reason = misfit(start, scene)) {
    if (request.keys.overridden("start")) request.keys.fail("start", fmt::format("it has {}", reason));
    scene.notes.push_back(fmt::format("start: {} is set aside, it has {}", file.filename().string(), reason));
    return;
  }
  scene.start.x = std::move(start.x);
  scene.start.v = std::move(start.v);
  scene.notes.clear();
  scene.positions_drawn = false;
}

void read_precision(const TomlTable& forcefield, Terms& terms) {
  if (forcefield.has("precision") && forcefield.choice("precision", {"double", "mixed"}) == "mixed")
    terms.precision = Precision::kMixed;
}

}  // namespace

void build(const BuildRequest& request, Scene& scene) {
  const Kind& kind = chosen_kind(request.keys);
  kind.build(request, scene);
  if (scene.names.empty()) scene.names = guessed_names(scene.system, scene.terms);
  if (scene.terms.nonbonded || scene.terms.wca) read_precision(request.forcefield, scene.terms);
  if (!kind.own_start) lay_start(request, scene);
  scene.start.f = Vectors::Zero(3, scene.system.atoms());
  if (scene.start.v.cols() == 0) scene.start.v = scene.start.f;
}

int atoms_of(const TomlTable& keys, std::string_view key, double copies, double atoms_each) {
  if (copies * atoms_each > kMostAtoms)
    keys.fail(key, fmt::format("{} make {} atoms, more than the {} taut takes", copies, copies * atoms_each,
                               kMostAtoms));
  return static_cast<int>(copies * atoms_each);
}

Names bead_names(int polymers, int beads) {
  Names names = repeated_names({{"BEAD", "POL", ""}}, polymers * beads);
  for (int& residue : names.residue) residue /= beads;
  return names;
}

namespace {

// A shifted cutoff is a reaction field of 1.
void read_coulomb(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded) {
  const bool charged = (nonbonded.charge.array() != 0).any();
  forcefield.counts("rf_dielectric", nonbonded.cutoff && charged,
                    "between charges, with forcefield.cutoff_nm");
  forcefield.counts("coulomb", charged, "between charges");
  const std::string coulomb = forcefield.has("coulomb")
                                  ? forcefield.choice("coulomb", {"reaction-field", "cutoff", "pme"})
                                  : "reaction-field";
  const bool field = coulomb == "reaction-field", pme = coulomb == "pme";
  if (forcefield.overridden("rf_dielectric") ||
      !forcefield.overridden("coulomb"))  // else the file's goes with it
    forcefield.counts("rf_dielectric", field, "with forcefield.coulomb = \"reaction-field\"");
  for (const char* key : {"ewald_tolerance", "ewald_alpha_per_nm", "pme_order", "pme_grid"})
    forcefield.counts(key, pme, "with forcefield.coulomb = \"pme\"");
  forcefield.counts("ewald_tolerance", !(forcefield.has("ewald_alpha_per_nm") && forcefield.has("pme_grid")),
                    "where ewald_alpha_per_nm or pme_grid is left to it");
  if (field) forcefield.read("rf_dielectric", nonbonded.rf_dielectric, Range{.min = 1});
  if (coulomb == "cutoff") nonbonded.rf_dielectric = 1;
  if (!field && !nonbonded.cutoff)
    forcefield.fail("coulomb", fmt::format("{} needs forcefield.cutoff_nm", coulomb));
  if (!pme) return;
  if (!box.periodic()) forcefield.fail("coulomb", "pme needs a box");
  PmeParameters& p = nonbonded.pme.emplace();
  Vec3 grid = Vec3::Zero();
  forcefield.read("ewald_tolerance", p.tolerance, kPositive);
  forcefield.read("ewald_alpha_per_nm", p.alpha, kPositive);
  forcefield.read("pme_order", p.order);
  if (forcefield.read("pme_grid", grid) && !(grid.array() == grid.array().floor() && grid.array() >= 1).all())
    forcefield.fail("pme_grid", "expected three whole numbers");
  for (int d = 0; d < 3; ++d) p.grid[d] = static_cast<int>(std::min(grid[d], 1e9));
  try {
    chosen_parameters(p, box, *nonbonded.cutoff);
  } catch (const InputError& e) {
    forcefield.fail("coulomb", e.what());
  }
}

}  // namespace

void read_cutoff(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded) {
  forcefield.read("cutoff_nm", nonbonded.cutoff, kPositive);
  forcefield.read("switch_nm", nonbonded.switch_distance, kPositive);
  forcefield.read("dispersion_correction", nonbonded.dispersion_correction);
  read_coulomb(forcefield, box, nonbonded);
  if (nonbonded.switch_distance && !(nonbonded.cutoff && *nonbonded.switch_distance < *nonbonded.cutoff))
    forcefield.fail("switch_nm", "expected less than forcefield.cutoff_nm");
  if (nonbonded.dispersion_correction && !(nonbonded.cutoff && box.periodic()))
    forcefield.fail("dispersion_correction", "needs a box and a cutoff");
  if (!box.periodic()) return;
  if (!nonbonded.cutoff) forcefield.get<double>("cutoff_nm");  // says it is missing
  const double half = box.edge.minCoeff() / 2;
  if (*nonbonded.cutoff > half)
    forcefield.fail("cutoff_nm", fmt::format("{} is over half the box, {:.4g}", *nonbonded.cutoff, half));
}

}  // namespace taut
