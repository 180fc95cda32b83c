#include <cmath>

#include "base/listen.hpp"
#include "base/random.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lattice.hpp"

namespace taut {
namespace {

constexpr int kMostWeighedBonds = 50;

struct Polymer {
  int copies, beads;
  double bond;  // [nm]
  double mass;  // [u]
};

// The bond directions u of a chain with rigid bonds are not independent; they are distributed as
//     P(u) ∝ √det A,   A_kk = 2/m,  A_k,k+1 = −u_k·u_{k+1}/m
// (Fixman 1974, doi:10.1073/pnas.71.8.3050); a trimer's angle has P(cosθ) ∝ √(1 − cos²θ/4). The determinant
// of the tridiagonal A follows from the recurrence D_k = 2D_{k−1} − c_k²D_{k−2}. Returns it over its upper
// bound 2ᴺ:
double relative_determinant(const Vectors& u) {
  double before = 1, now = 1;  // D_{k−1}/2ᵏ⁻¹, D_k/2ᵏ
  for (Eigen::Index k = 1; k < u.cols(); ++k) {
    const double c = u.col(k).dot(u.col(k - 1));
    before = std::exchange(now, now - c * c * before / 4);
  }
  return now;
}

// Returns the directions of a chain's bonds: from that distribution by rejection if that is cheap, else
// uniform.
Vectors chain_directions(int bonds, Random& random) {
  Vectors u(3, bonds);
  for (;;) {
    for (int k = 0; k < bonds; ++k) u.col(k) = random.unit_vector();
    if (bonds > kMostWeighedBonds) return u;
    const double accept = random.uniform();
    if (accept * accept < relative_determinant(u)) return u;
  }
}

Polymer read_polymer(const TomlTable& keys) {
  const auto copies = keys.get<long>("chains", {"how many", Range{.min = 1}});
  const auto beads = keys.get<long>("beads", {"beads in each", Range{.min = 2}});
  atoms_of(keys, "chains", static_cast<double>(copies), static_cast<double>(beads));
  Polymer polymer{static_cast<int>(copies), static_cast<int>(beads), 1, 1};
  polymer.bond = keys.get<double>("bond_nm", {"length of a bond", "nm", kPositive});
  polymer.mass = keys.get<double>("mass_u", {"mass of a bead", "u", kPositive});
  return polymer;
}

// Places copies apart on a grid (they do not interact); bead b + 1 of a copy lies one bond from bead b.
void place(const Polymer& polymer, auto&& directions, Scene& scene) {
  const auto& [copies, beads, bond, mass] = polymer;
  const double spacing = 3 * bond * std::sqrt(beads);
  const int side = static_cast<int>(std::ceil(std::cbrt(copies)));
  std::vector<RigidBond> bonds;
  scene.start.x.resize(3, copies * beads);
  for (int c = 0; c < copies; ++c) {
    const int first = c * beads;
    const Vectors u = directions();
    scene.start.x.col(first) = spacing * cube_cell(c, side);
    for (int b = 0; b + 1 < beads; ++b) {
      scene.start.x.col(first + b + 1) = scene.start.x.col(first + b) + bond * u.col(b);
      bonds.push_back({first + b, first + b + 1, bond});
    }
  }
  scene.names = bead_names(copies, beads);
  scene.system = make_system(Eigen::VectorXd::Constant(copies * beads, mass), std::move(bonds));
}

}  // namespace

// kind = "chains": freely jointed chains without forces, independent of each other.
// For up to 50 bonds per chain the start is drawn from equilibrium.
void build_chains(const BuildRequest& request, Scene& scene) {
  const Polymer polymer = read_polymer(request.keys);
  if (request.keys.describing()) return;
  Random random(request.run.seed);
  scene.positions_drawn = true;
  if (polymer.beads - 1 > kMostWeighedBonds)
    scene.notes.emplace_back("start: bond directions drawn evenly, not by the rigid chain's own law");
  const auto directions = [&] {
    hear();
    return chain_directions(polymer.beads - 1, random);
  };
  place(polymer, directions, scene);
}

}  // namespace taut
