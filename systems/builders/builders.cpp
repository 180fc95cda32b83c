#include "systems/builders/builders.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "md/largest_system.hpp"
#include "md/observables.hpp"
#include "systems/molecules/read_molecule.hpp"
#include "systems/molecules/rows.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

struct Kind {
  std::string_view name;
  void (*build)(const BuildRequest&, Scene&);
  bool own_start = false;  // whether the builder reads build.start itself
};
constexpr std::array kKinds = {Kind{"atoms", build_atoms},   Kind{"chains", build_chains},
                               Kind{"melt", build_melt},     Kind{"water", build_water, true},
                               Kind{"lammps", build_lammps}, Kind{"molecules", build_molecules, true}};

// [[place]] implies kind = "molecules"; with another kind it would have no effect.
const Kind& chosen_kind(const TomlTable& root, const TomlTable& keys) {
  std::string name = root.has("place") ? "molecules" : "";
  if (std::string said; keys.has("kind") && keys.read("kind", said) && (said == "alkane" || said == "rings"))
    keys.fail("kind", "alkanes and rings are [molecule]s: start from decane.toml or ring.toml");
  if (name.empty() && !keys.has("kind") && !keys.describing())
    keys.fail("kind", fmt::format("not said: place molecules ([[place]]), or say one of {}",
                                  fmt::join(kinds(), ", ")));
  if (name.empty() || keys.has("kind"))
    name = keys.choice("kind", kinds(), "what is built; not said beside [[place]]: molecules");
  for (const char* key : {"place", "molecule", "atom", "pair"})
    root.require_effect(key, name == "molecules", "with build.kind = \"molecules\"");
  return *std::ranges::find(kKinds, name, &Kind::name);
}

// Returns why a start does not fit this scene, or null if it does.
const char* misfit(const State& start, const Scene& scene) {
  const Vectors& x = start.x;
  if (x.cols() != scene.system.atoms()) return "another number of atoms";
  if (!start.box.vectors().isApprox(scene.start.box.vectors(), 1e-9)) return "another box";
  if (bond_errors(scene.system, x).max > 0.01) return "other bonds";
  for (const Fene& spring : scene.terms.fene)
    if (scene.system.apart(start.box, spring.i, spring.j, x).norm() >= spring.r0) return "other springs";
  return nullptr;
}

// Refuses keys of pair forces that have no effect. If an override makes the pairs WCA, the file's keys are
// ignored, with a note.
void refuse_idle_pair_keys(const TomlTable& forcefield, Scene& scene) {
  if (scene.terms.nonbonded) return;
  const bool wca = scene.terms.wca.has_value();
  for (const char* key :
       {"cutoff_nm", "switch_nm", "shift", "dispersion_correction", "coulomb", "dielectric", "rf_dielectric",
        "rf_excluded", "ewald_tolerance", "ewald_alpha_per_nm", "pme_order", "pme_grid"}) {
    if (!forcefield.has(key)) continue;
    if (wca && forcefield.overridden("pair") && !forcefield.overridden(key))
      scene.notes.push_back(
          fmt::format("forcefield.{} is set aside: pairs of wca end at 2^(1/6) sigma", key));
    else
      forcefield.require_effect(
          key, false,
          wca ? "with forcefield.pair = \"lennard-jones\" or charges: pairs of wca end at 2^(1/6) sigma"
          : scene.terms.tabulated_pairs
              ? "with charges or Lennard-Jones: all pairs have tables here, which end where they end"
              : "with pair forces: no atom has a charge or an epsilon_kj_mol here");
  }
}

}  // namespace

std::vector<std::string_view> kinds() {
  std::vector<std::string_view> names(kKinds.size());
  std::ranges::transform(kKinds, names.begin(), &Kind::name);
  return names;
}

std::optional<State> read_named_start(const BuildRequest& request) {
  std::filesystem::path file;
  if (!request.keys.read("start", file, "positions and velocities, of a run of the same scene")) return {};
  return read_start(file);
}

bool take_start(const BuildRequest& request, State start, Scene& scene) {
  if (const char* reason = misfit(start, scene)) {
    if (request.keys.overridden("start")) request.keys.fail("start", fmt::format("it has {}", reason));
    const auto file = request.keys.get<std::filesystem::path>("start");
    scene.notes.push_back(fmt::format("start: {} is set aside, it has {}", file.filename().string(), reason));
    return false;
  }
  scene.start.x = std::move(start.x);
  scene.start.v = std::move(start.v);
  scene.notes.clear();
  scene.positions_drawn = false;
  return true;
}

void read_precision(const TomlTable& forcefield, Terms& terms) {
  std::string precision = terms.precision == Precision::kMixed ? "mixed" : "double";
  forcefield.read("precision", precision,
                  {"what pair forces are computed in (taut run --openmm: mixed)", {"double", "mixed"}});
  terms.precision = precision == "mixed" ? Precision::kMixed : Precision::kDouble;
}

void build(BuildRequest request, Scene& scene, std::string_view described) {
  const Kind& chosen = chosen_kind(request.root, request.keys);
  const Kind& kind = described.empty() ? chosen : *std::ranges::find(kKinds, described, &Kind::name);
  request.walls = read_walls(request.root);
  kind.build(request, scene);
  if (scene.terms.nonbonded || scene.terms.wca || scene.terms.tabulated_pairs)
    read_precision(request.forcefield, scene.terms);
  if (!kind.own_start)
    if (auto start = read_named_start(request)) take_start(request, std::move(*start), scene);
  if (request.keys.describing()) return;
  refuse_idle_pair_keys(request.forcefield, scene);
  if (scene.names.empty()) scene.names = guessed_names(scene.system, scene.terms);
  make_walls(request.root, request.walls, scene);
  tie_steered_atoms(scene.start, scene.terms);
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

// Reads how charges act. A shifted cutoff is a reaction field with ε = 1. Without a key the value of `given`
// stays; a new tolerance determines α and the grid anew.
struct Coulomb {
  std::string kind;
  double dielectric, rf_dielectric;  // the latter 0 where it is infinite
  bool rf_excluded;
  PmeParameters pme;
  std::optional<double> alpha;
  std::optional<Vec3> grid;

  Coulomb(const TomlTable& keys, const Nonbonded& given)
      : kind(kind_of(given)),
        dielectric(given.dielectric),
        rf_dielectric(std::isinf(given.rf_dielectric) ? 0 : given.rf_dielectric),
        rf_excluded(given.rf_excluded),
        pme(given.pme.value_or(PmeParameters{})) {
    if (pme.alpha > 0 && !keys.has("ewald_tolerance")) alpha = pme.alpha;
    if (pme.grid[0] > 0 && !keys.has("ewald_tolerance")) grid = Vec3(pme.grid[0], pme.grid[1], pme.grid[2]);
    keys.read("coulomb", kind, {"between charges", {"reaction-field", "cutoff", "pme"}});
    keys.read("dielectric", dielectric, {"ε by which all Coulomb energies are divided", kPositive});
    keys.read("rf_dielectric", rf_dielectric,
              {"ε of the reaction field beyond the cutoff; 0: infinite; 1: a shifted cutoff", kNotNegative});
    if (rf_dielectric > 0 && rf_dielectric < 1)
      keys.fail("rf_dielectric", fmt::format("{}, expected 1 or more, or 0 for infinite", rf_dielectric));
    keys.read("rf_excluded", rf_excluded,
              {"the field also between excluded charges and of each on itself, as in GROMACS"});
    keys.read("ewald_tolerance", pme.tolerance,
              {"about what forces are wrong by, as a share; gives α and grid", kPositive});
    keys.read("ewald_alpha_per_nm", alpha,
              {"α of Ewald's sum; not said: by the tolerance", "1/nm", kPositive});
    keys.read("pme_order", pme.order, {"order of the splines, 4 to 8"});
    keys.read("pme_grid", grid, {"points of the grid along the edges; not said: by the tolerance"});
  }

  static std::string kind_of(const Nonbonded& nonbonded) {
    if (nonbonded.pme) return "pme";
    return nonbonded.cutoff && nonbonded.rf_dielectric == 1 ? "cutoff" : "reaction-field";
  }
};

void read_coulomb(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded) {
  const Coulomb coulomb(forcefield, nonbonded);
  const bool charged = (nonbonded.charge.array() != 0).any();
  forcefield.require_effect("rf_dielectric", nonbonded.cutoff && charged,
                            "between charges, with forcefield.cutoff_nm");
  for (const char* key : {"coulomb", "dielectric"})
    forcefield.require_effect(key, charged, "between charges");
  const bool field = coulomb.kind == "reaction-field", pme = coulomb.kind == "pme";
  if (forcefield.overridden("rf_dielectric") ||
      !forcefield.overridden("coulomb"))  // else it replaces the file's
    forcefield.require_effect("rf_dielectric", field, "with forcefield.coulomb = \"reaction-field\"");
  forcefield.require_effect("rf_excluded", nonbonded.cutoff && charged && coulomb.kind != "pme",
                            "between charges, with forcefield.cutoff_nm, without pme");
  for (const char* key : {"ewald_tolerance", "ewald_alpha_per_nm", "pme_order", "pme_grid"})
    forcefield.require_effect(key, pme, "with forcefield.coulomb = \"pme\"");
  forcefield.require_effect("ewald_tolerance",
                            !(forcefield.has("ewald_alpha_per_nm") && forcefield.has("pme_grid")),
                            "where ewald_alpha_per_nm or pme_grid is left to it");
  nonbonded.dielectric = coulomb.dielectric;
  nonbonded.rf_excluded = coulomb.rf_excluded && !pme;
  if (field) nonbonded.rf_dielectric = coulomb.rf_dielectric == 0 ? HUGE_VAL : coulomb.rf_dielectric;
  if (coulomb.kind == "cutoff") nonbonded.rf_dielectric = 1;
  if (!field && !nonbonded.cutoff)
    forcefield.fail("coulomb", fmt::format("{} needs forcefield.cutoff_nm", coulomb.kind));
  nonbonded.pme.reset();
  if (!pme) return;
  if (!box.periodic()) forcefield.fail("coulomb", "pme needs a box");
  PmeParameters& p = nonbonded.pme.emplace(coulomb.pme);
  p.alpha = coulomb.alpha.value_or(0);
  p.grid = {};
  if (const auto& grid = coulomb.grid) {
    if (!(grid->array() == grid->array().floor() && grid->array() >= 1).all())
      forcefield.fail("pme_grid", "expected three whole numbers");
    for (int d = 0; d < 3; ++d) p.grid[d] = static_cast<int>(std::min((*grid)[d], 1e9));
  }
  try {
    chosen_parameters(p, box, *nonbonded.cutoff);
  } catch (const PmeError& e) {
    const std::string_view keys[] = {"pme_order", "ewald_tolerance",
                                     coulomb.alpha ? "ewald_alpha_per_nm" : "ewald_tolerance",
                                     coulomb.grid ? "pme_grid" : "ewald_tolerance"};
    const std::string_view key = keys[e.wrong];
    forcefield.fail(forcefield.has(key) ? key : "coulomb", e.what());
  }
}

}  // namespace

void read_cutoff(const TomlTable& forcefield, const Box& box, Nonbonded& nonbonded) {
  forcefield.read("cutoff_nm", nonbonded.cutoff,
                  {"pair forces end there; required with a box, at most half of it", "nm", kPositive});
  forcefield.read("switch_nm", nonbonded.switch_distance,
                  {"Lennard-Jones is switched to zero from there to the cutoff", "nm", kPositive});
  forcefield.read("shift", nonbonded.shifted, {"Lennard-Jones of each pair is raised to zero at the cutoff"});
  forcefield.read("dispersion_correction", nonbonded.dispersion_correction,
                  {"Lennard-Jones beyond the cutoff, on the average"});
  read_coulomb(forcefield, box, nonbonded);
  if (nonbonded.switch_distance && !(nonbonded.cutoff && *nonbonded.switch_distance < *nonbonded.cutoff))
    forcefield.fail("switch_nm", "expected less than forcefield.cutoff_nm");
  if (nonbonded.shifted && !nonbonded.cutoff) forcefield.fail("shift", "needs forcefield.cutoff_nm");
  for (const auto& [there, key] : {std::pair{nonbonded.switch_distance.has_value(), "switch_nm"},
                                   std::pair{nonbonded.dispersion_correction, "dispersion_correction"}})
    if (nonbonded.shifted && there)
      forcefield.fail("shift",
                      fmt::format("raises what ends at the cutoff; leave it or forcefield.{} out", key));
  if (nonbonded.dispersion_correction && !(nonbonded.cutoff && box.periodic()))
    forcefield.fail("dispersion_correction", "needs a box and a cutoff");
  if (!box.periodic()) return;
  if (!nonbonded.cutoff) forcefield.get<double>("cutoff_nm");  // reports that it is missing
  const double half = box.edge.minCoeff() / 2;
  if (*nonbonded.cutoff > half)
    forcefield.fail("cutoff_nm", fmt::format("{} is over half the box, {:.4g}", *nonbonded.cutoff, half));
}

}  // namespace taut
