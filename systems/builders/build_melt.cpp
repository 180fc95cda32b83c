#include <fmt/format.h>

#include <cmath>

#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"

namespace taut {
namespace {

constexpr double kContact = 1.122462048309373;  // 2^(1/6): distance of two touching beads, in σ

struct Beads {
  int chains, beads;
  double bond;     // [nm]
  double mass;     // [u]
  double density;  // [1/nm³]
  double sigma;    // [nm]
  double epsilon;  // [kJ/mol]
  bool rigid;      // or FENE
  bool repulsive;  // or with the attraction of Lennard-Jones

  int atoms() const { return chains * beads; }
};

Beads read_beads(const BuildRequest& request) {
  const TomlTable& keys = request.keys;
  const auto chains = keys.get<long>("chains", {"how many", Range{.min = 1}});
  const auto beads = keys.get<long>("beads", {"beads in each", Range{.min = 1}});
  atoms_of(keys, "chains", static_cast<double>(chains), static_cast<double>(beads));
  Beads melt{};
  melt.chains = static_cast<int>(chains);
  melt.beads = static_cast<int>(beads);
  melt.bond = keys.get<double>("bond_nm", {"length of a bond", "nm", kPositive});
  melt.mass = keys.get<double>("mass_u", {"mass of a bead", "u", kPositive});
  melt.density = keys.get<double>("density_per_nm3", {"beads in a volume", "1/nm³", kPositive});
  melt.rigid = keys.choice("bonds", {"rigid", "fene"}, "what ties the beads of a chain") == "rigid";
  melt.sigma = request.forcefield.get<double>("sigma_nm", {"σ of a pair of beads", "nm", kPositive});
  melt.epsilon =
      request.forcefield.get<double>("epsilon_kj_mol", {"ε of a pair of beads", "kJ/mol", kNotNegative});
  melt.repulsive = request.forcefield.choice("pair", {"wca", "lennard-jones"},
                                             "the force between beads: purely repulsive, or not") == "wca";
  return melt;
}

// One path fills the box and is cut into chains. It goes up a column of beads at distance b and down the next
// column. The columns are at distance s; the last bead of one and the first of the next are displaced toward
// each other by δ = (s − b)/2, at a height √(b² − δ²) above the bead before, so that the bond between them
// has the right length, too. Layers that face each other across the box are at contact distance, and at melt
// densities s exceeds it: no beads overlap.
struct Path {
  double bond;
  Grid grid;
  HexagonalColumns columns;

  Vec3 bead(long t) const {
    const long c = t / grid.nz, along = t % grid.nz;
    const bool up = c % 2 == 0, first = along == 0 && c > 0, last = along == grid.nz - 1;
    const long layer = up ? along : grid.nz - 1 - along;
    Vec3 x = columns.column(grid, c) + Vec3(0, 0, bond * static_cast<double>(layer));
    if (!first && !last) return x;
    const double lean = (columns.spacing - bond) / 2;
    const Vec3 other = columns.column(grid, first ? c - 1 : c + 1);
    x += lean * (other - columns.column(grid, c)) / columns.spacing;
    x.z() += (up == first ? 1 : -1) * (bond - std::sqrt(bond * bond - lean * lean));
    return x;
  }
};

// Sets the box and returns the path in it. The beads of a column give one edge, the density gives the others.
Path build_path(const TomlTable& keys, const Beads& melt, Box& box) {
  const auto columns = HexagonalColumns::of_area(1 / (melt.density * melt.bond));
  Path path{melt.bond, fit_grid(melt.atoms(), columns.cell(melt.bond), 2), columns};
  path.grid.nz = std::max(path.grid.nz, 3);
  const double height = melt.bond * (path.grid.nz - 1) + kContact * melt.sigma;
  const double area = melt.atoms() / melt.density / height / static_cast<double>(path.grid.columns());
  path.columns = HexagonalColumns::of_area(area);
  const double s = path.columns.spacing;
  if (s < 0.8 * melt.sigma || s > 2.9 * melt.bond)
    keys.fail("density_per_nm3",
              fmt::format("{} is too {}: the chains of the start would lie {:.3g} nm apart", melt.density,
                          s < melt.sigma ? "high" : "low", s));
  box.edge = path.columns.cell(height).cwiseProduct(Vec3(path.grid.nx, path.grid.ny, 1));
  return path;
}

// Kremer and Grest 1990 (doi:10.1063/1.458541): FENE with k = 30 ε/σ², r₀ = 1.5 σ, besides the pair force.
void tie(const Beads& melt, std::vector<RigidBond>& rigid, std::vector<Fene>& fene) {
  for (int a = 0; a + 1 < melt.atoms(); ++a) {
    if ((a + 1) % melt.beads == 0) continue;
    if (melt.rigid)
      rigid.push_back({a, a + 1, melt.bond});
    else
      fene.push_back({a, a + 1, 30 * melt.epsilon / (melt.sigma * melt.sigma), 1.5 * melt.sigma});
  }
}

void add_pair_force(const BuildRequest& request, const Beads& melt, Scene& scene) {
  const auto& bonds = scene.system.bonds;
  if (melt.repulsive) {
    Wca& wca = scene.terms.wca.emplace(Wca{melt.sigma, melt.epsilon, {}});
    for (const auto& [i, j, length] : bonds) wca.exclusions.push_back({i, j});
  } else {
    Nonbonded& lj = scene.terms.nonbonded.emplace();
    lj.charge = Eigen::VectorXd::Zero(melt.atoms());
    lj.sigma = Eigen::VectorXd::Constant(melt.atoms(), melt.sigma);
    lj.epsilon = Eigen::VectorXd::Constant(melt.atoms(), melt.epsilon);
    for (const auto& [i, j, length] : bonds) lj.exceptions.push_back({i, j, 0, melt.sigma, 0});
    read_cutoff(request.forcefield, scene.start.box, lj);
  }
}

}  // namespace

// kind = "melt": chains of beads that fill a box. All pairs interact except those of a rigid bond; with
// Lennard-Jones the keys of read_cutoff apply.
void build_melt(const BuildRequest& request, Scene& scene) {
  const Beads melt = read_beads(request);
  if (request.keys.describing()) return read_cutoff(request.forcefield, {}, scene.terms.nonbonded.emplace());
  const Path path = build_path(request.keys, melt, scene.start.box);
  scene.start.x.resize(3, melt.atoms());
  for (int a = 0; a < melt.atoms(); ++a) scene.start.x.col(a) = path.bead(a);
  std::vector<RigidBond> bonds;
  tie(melt, bonds, scene.terms.fene);
  scene.system = make_system(Eigen::VectorXd::Constant(melt.atoms(), melt.mass), std::move(bonds));
  scene.names = bead_names(melt.chains, melt.beads);
  add_pair_force(request, melt, scene);
  scene.notes.emplace_back("start: straight columns of beads, which a run of its own should first melt");
}

}  // namespace taut
