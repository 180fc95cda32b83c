#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "md/random.hpp"
#include "md/units.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"

// n-Alkanes as united atoms, TraPPE-UA (Martin and Siepmann 1998, doi:10.1021/jp972543+), bonds rigid.
// Its energies are in kelvin.

namespace taut {
namespace {

constexpr double kBond = 0.154;                            // [nm]
constexpr double kAngle = 114 * std::numbers::pi / 180;    // [rad]
constexpr double kAngleStiffness = 62500 * kBoltzmann;     // ½kθ(θ−θ₀)² [kJ/mol/rad²]
constexpr double kEndGap = 0.40;                           // between chains end to end [nm]
constexpr double kMassEnd = 15.035, kMassMiddle = 14.027;  // CH3, CH2 [u]
constexpr double kSigmaEnd = 0.375, kSigmaMiddle = 0.395;  // [nm]
constexpr double kEpsilonEnd = 98 * kBoltzmann, kEpsilonMiddle = 46 * kBoltzmann;  // [kJ/mol]

// U = c₁(1 + cosφ) + c₂(1 − cos2φ) + c₃(1 + cos3φ), trans at φ = π. With ψ = φ − π and c = cosψ:
// cosφ = −c, cos2φ = 2c² − 1, cos3φ = 3c − 4c³, so that
// U = (c₁ + 2c₂ + c₃) + (3c₃ − c₁)c − 2c₂c² − 4c₃c³.
constexpr std::array<double, 6> ryckaert_bellemans() {
  constexpr double c1 = 355.03 * kBoltzmann, c2 = -68.19 * kBoltzmann, c3 = 791.32 * kBoltzmann;
  return {c1 + 2 * c2 + c3, 3 * c3 - c1, -2 * c2, -4 * c3, 0, 0};
}

struct Liquid {
  int molecules, carbons;
  double density;  // [u/nm³]

  int atoms() const { return molecules * carbons; }
  double mass() const { return 2 * kMassEnd + (carbons - 2) * kMassMiddle; }
  double volume() const { return molecules * mass() / density; }
};

// All-trans chains along z, each turned about its axis at random, in hexagonal columns of layers.
void place(const Liquid& liquid, Random& random, State& start) {
  const double rise = kBond * std::sin(kAngle / 2), half_width = kBond * std::cos(kAngle / 2) / 2;
  const double layer = rise * (liquid.carbons - 1) + kEndGap;
  const auto ideal = HexagonalColumns::of_area(liquid.volume() / liquid.molecules / layer);
  const Grid grid = fit_grid(liquid.molecules, ideal.cell(layer), 2);
  const double height = layer * grid.nz;
  const auto columns =
      HexagonalColumns::of_area(liquid.volume() / height / static_cast<double>(grid.columns()));
  start.box.edge = columns.cell(height).cwiseProduct(Vec3(grid.nx, grid.ny, 1));

  Vectors& x = start.x;
  x.resize(3, liquid.atoms());
  for (int m = 0; m < liquid.molecules; ++m) {
    const long site = m * grid.sites() / liquid.molecules;  // empty sites are spread evenly
    const Vec3 foot =
        columns.column(grid, site / grid.nz) + Vec3(0, 0, layer * static_cast<double>(site % grid.nz));
    const double turn = 2 * std::numbers::pi * random.uniform();
    const Vec3 sideways = half_width * Vec3(std::cos(turn), std::sin(turn), 0);
    for (int c = 0; c < liquid.carbons; ++c)
      x.col(m * liquid.carbons + c) = foot + Vec3(0, 0, c * rise) + (c % 2 == 0 ? 1 : -1) * sideways;
  }
}

bool is_end(const Liquid& liquid, int atom) {
  const int c = atom % liquid.carbons;
  return c == 0 || c == liquid.carbons - 1;
}

std::vector<AtomKind> united_atoms(int carbons) {
  std::vector<AtomKind> molecule;
  for (int c = 1; c <= carbons; ++c) molecule.push_back({c < 1000 ? fmt::format("C{}", c) : "C", "ALK", "C"});
  return molecule;
}

// Angles, torsions, and no pair force up to three bonds apart.
void add_forces_of_molecule(const Liquid& liquid, int first, Terms& terms) {
  for (int c = 0; c < liquid.carbons; ++c) {
    const int a = first + c, left = liquid.carbons - 1 - c;
    if (left >= 2) terms.angles.push_back({a, a + 1, a + 2, kAngle, kAngleStiffness});
    if (left >= 3) terms.rb_torsions.push_back({a, a + 1, a + 2, a + 3, ryckaert_bellemans()});
    for (int apart = 1; apart <= std::min(3, left); ++apart)
      terms.nonbonded->exceptions.push_back({a, a + apart, 0, kSigmaMiddle, 0});
  }
}

}  // namespace

// kind = "alkane": a liquid of n-alkanes, with the keys of read_cutoff.
void build_alkane(const BuildRequest& request, Scene& scene) {
  const TomlTable& keys = request.keys;
  const auto molecules = keys.get<long>("molecules", {"how many", Range{.min = 1}});
  const auto carbons = keys.get<long>("carbons", {"carbons in each", Range{.min = 2}});
  atoms_of(keys, "molecules", static_cast<double>(molecules), static_cast<double>(carbons));
  const Liquid liquid{
      static_cast<int>(molecules), static_cast<int>(carbons),
      keys.get<double>("density_g_cm3", {"density of the box", "g/cm³", kPositive}) * kGramPerCm3};
  if (keys.describing()) return read_cutoff(request.forcefield, {}, scene.terms.nonbonded.emplace());

  Random random(request.run.seed);
  scene.positions_drawn = true;
  place(liquid, random, scene.start);

  Eigen::VectorXd mass(liquid.atoms());
  std::vector<RigidBond> bonds;
  Nonbonded& lj = scene.terms.nonbonded.emplace();
  lj.charge = Eigen::VectorXd::Zero(liquid.atoms());
  lj.sigma.resize(liquid.atoms());
  lj.epsilon.resize(liquid.atoms());
  for (int a = 0; a < liquid.atoms(); ++a) {
    const bool end = is_end(liquid, a);
    mass[a] = end ? kMassEnd : kMassMiddle;
    lj.sigma[a] = end ? kSigmaEnd : kSigmaMiddle;
    lj.epsilon[a] = end ? kEpsilonEnd : kEpsilonMiddle;
    if ((a + 1) % liquid.carbons != 0) bonds.push_back({a, a + 1, kBond});
  }
  for (int m = 0; m < liquid.molecules; ++m) add_forces_of_molecule(liquid, m * liquid.carbons, scene.terms);
  scene.names = repeated_names(united_atoms(liquid.carbons), liquid.molecules);
  read_cutoff(request.forcefield, scene.start.box, lj);
  scene.system = make_system(std::move(mass), std::move(bonds));
  scene.notes.emplace_back("start: all-trans chains side by side, which a run of its own should first melt");
}

}  // namespace taut
