#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/course.hpp"
#include "base/vectors.hpp"
#include "forcefield/bias.hpp"
#include "forcefield/spline.hpp"
#include "md/units.hpp"

namespace taut {

// Force terms as plain data, in OpenMM's conventions. Angles in radians.

struct HarmonicBond {  // ½k(r − length)²
  int i, j;
  double length;  // [nm]
  double k;       // [kJ/mol/nm²]
};

struct HarmonicAngle {  // ½k(θ − angle)², θ at atom j
  int i, j, k;
  double angle;      // [rad]
  double stiffness;  // [kJ/mol/rad²]
};

// K(1 + cos θ), the stiffness of semiflexible chains; LAMMPS's angle_style cosine.
struct CosineAngle {
  int i, j, k;
  double stiffness;  // K [kJ/mol]
};

// ½K(cos θ − cos θ₀)², harmonic near θ₀ and without a singularity where the atoms are in line; LAMMPS's angle_style
// cosine/squared, GROMACS's angles of type 2 (van Gunsteren and Berendsen 1987).
struct CosineSquaredAngle {
  int i, j, k;
  double cosine;     // cos θ₀
  double stiffness;  // K [kJ/mol]
};

// ½K(cos θ − cos θ₀)²/sin²θ, which keeps three atoms out of line; GROMACS's angles of type 10 (Bulacu et al. 2013,
// doi:10.1021/ct400219n).
struct RestrictedAngle {
  int i, j, k;
  double cosine;     // cos θ₀
  double stiffness;  // K [kJ/mol]
};

// Energies of a distance r [nm] or an angle θ [rad] by a table [kJ/mol] (bonded/tabulated.hpp).
struct TabulatedBond {
  int i, j;
  std::shared_ptr<const Spline> energy;
};
struct TabulatedAngle {
  int i, j, k;
  std::shared_ptr<const Spline> energy;
};

struct PeriodicTorsion {  // k(1 + cos(nφ − phase))
  int i, j, k, l;
  int periodicity;
  double phase;      // [rad]
  double amplitude;  // [kJ/mol]
};

struct RyckaertBellemans {  // Σ c_n cosⁿ(φ − π)
  int i, j, k, l;
  std::array<double, 6> c;  // [kJ/mol]
};

struct HarmonicTorsion {  // ½k(φ − angle)², the shorter way round
  int i, j, k, l;
  double angle;      // [rad]
  double stiffness;  // [kJ/mol/rad²]
};

// sin³θ₁ sin³θ₂ Σ c_n cosⁿφ, which fades where three of the atoms are in line; GROMACS's dihedrals of type 11 (Bulacu et
// al. 2013).
struct BendingTorsion {
  int i, j, k, l;
  std::array<double, 5> c;  // [kJ/mol]
};

// A CHARMM correction map (cmap.hpp): E of two dihedrals, between the points of one of Terms::maps.
struct CmapTorsion {
  std::array<int, 4> phi, psi;
  int map;
};

struct Fene {  // −½k r₀² ln(1 − (r/r₀)²)
  int i, j;
  double k;   // [kJ/mol/nm²]
  double r0;  // [nm]
};

// A pair that leaves the general sum and interacts by its own numbers instead, without cutoff or
// reaction field. Zeros make it a plain exclusion.
struct PairException {
  int i, j;
  double charge_product;  // [e²]
  double sigma;           // [nm]
  double epsilon;         // [kJ/mol]
};

// k qq (k_rf r² − c_rf) up to a cutoff: what the reaction field leaves between two charges that exclude each other.
struct FieldPair {
  int i, j;
  double curvature;  // k qq k_rf [kJ/mol/nm²]
  double depth;      // k qq c_rf [kJ/mol]
  double cutoff;     // [nm]
};

// Coulomb of all periodic images by particle mesh Ewald (ewald/pme.hpp). Zeros are chosen by the tolerance.
struct PmeParameters {
  double tolerance = 5e-4;    // about what forces are wrong by, as a share
  int order = 5;              // of the splines, 4 to 8
  double alpha = 0;           // [1/nm]
  std::array<int, 3> grid{};  // points along the edges
};

// Lennard-Jones between types of atoms, a/r¹² − b/r⁶, where no rule of mixing has it.
struct LennardJonesTable {
  std::vector<int> type;  // n
  Eigen::MatrixXd a, b;   // types x types, symmetric [kJ/mol·nm¹², kJ/mol·nm⁶]
};

// Lennard-Jones with Lorentz–Berthelot mixing or by a table, and Coulomb.
struct Nonbonded {
  Eigen::VectorXd charge;   // [e], n
  Eigen::VectorXd sigma;    // [nm], n
  Eigen::VectorXd epsilon;  // [kJ/mol], n
  std::vector<PairException> exceptions;
  std::optional<double> cutoff;           // [nm]; none: every pair
  std::optional<double> switch_distance;  // [nm]: Lennard-Jones switched to zero from here to the cutoff
  double rf_dielectric = 78.3;            // ε of the reaction field beyond the cutoff; 1: a shifted cutoff
  std::optional<PmeParameters> pme;       // in place of the reaction field
  bool dispersion_correction = false;     // long-range Lennard-Jones, periodic only
  std::optional<LennardJonesTable> lj_table{};  // in place of sigma and epsilon
  bool rf_excluded = false;  // it also acts between excluded charges, and of each on itself
  double dielectric = 1;     // by which all Coulomb energies are divided
  bool shifted = false;      // Lennard-Jones of each pair is raised to zero at the cutoff

  double coulomb() const { return kCoulomb / dielectric; }  // [kJ/mol·nm/e²]

  // k_rf and c_rf of a cutoff (pairs/pair_kernels.hpp).
  struct ReactionField {
    double k, c;  // [1/nm³], [1/nm]
  };
  ReactionField reaction_field() const {
    const double rc = *cutoff, eps = rf_dielectric;
    if (std::isinf(eps)) return {1 / (2 * rc * rc * rc), 3 / (2 * rc)};
    return {(eps - 1) / ((2 * eps + 1) * rc * rc * rc), 3 * eps / ((2 * eps + 1) * rc)};
  }
};

// Purely repulsive beads of one kind: 4ε((σ/r)¹² − (σ/r)⁶) + ε up to r = 2^(1/6)σ.
struct Wca {
  double sigma;    // [nm]
  double epsilon;  // [kJ/mol]
  std::vector<std::array<int, 2>> exclusions;
  std::vector<int> without{};  // atoms on which it does not act

  double cutoff() const { return std::pow(2.0, 1.0 / 6) * sigma; }  // [nm]
};

// Pair energies by tables of the distance, between two kinds of atoms each, from a table's first distance to its
// last, its cutoff. They add to what else acts between the atoms.
struct TabulatedPairs {
  struct Potential {
    int one, two;                          // kinds, in either order
    std::shared_ptr<const Spline> energy;  // of r [nm, kJ/mol]
  };
  std::vector<int> kind;  // n: of each atom, from 0; −1: no table is of it
  std::vector<Potential> potentials;
  std::vector<std::array<int, 2>> exclusions;

  double cutoff() const {  // the largest [nm]
    double most = 0;
    for (const Potential& p : potentials) most = std::max(most, p.energy->last());
    return most;
  }
};

struct Pull {  // a force on one atom that depends on no position, times Terms::pull_factor
  int atom;
  Vec3 force;  // [kJ/mol/nm]
};

// ½k max(|P(x − at)| − free, 0)² on one atom, where P keeps the axes along which it is held.
struct Restraint {
  int atom;
  Vec3 at;                  // [nm]
  double k;                 // [kJ/mol/nm²]
  Vec3 axes{1, 1, 1};       // 1 or 0 of each
  double free = 0;          // [nm]
  int side = 0;             // of the one axis: 1: acts above its place alone, −1: below
  bool takes_image = true;  // of the place the nearest
};

// A flat wall across an axis, on the atoms at distance z in front of it: E = ε(2/15 (σ/z)⁹ − (σ/z)³), raised to
// zero at the cutoff. A wall of Lennard-Jones atoms that fill the space behind it has this energy (Steele 1973,
// doi:10.1016/0039-6028(73)90264-1). With the cutoff at its minimum, z = (2/5)^(1/6) σ, it only repels.
struct Wall {
  int axis;                      // 0, 1, 2: x, y, z
  double at;                     // its place along the axis [nm]
  int faces;                     // 1: atoms are above, −1: below
  double sigma;                  // [nm]
  double epsilon;                // [kJ/mol]
  std::optional<double> cutoff;  // [nm]
  std::vector<int> atoms;        // on which it acts

  static double repulsive_cutoff(double sigma) { return std::pow(0.4, 1.0 / 6) * sigma; }
};

// A spring on one atom whose other end moves at constant speed (steered molecular dynamics, Isralewitz, Gao and
// Schulten 2001, doi:10.1016/S0959-440X(00)00194-9): ½k(speed·(t − since) − along·(x − from))². Across `along`
// the atom is free.
struct SteeredAtom {
  int atom;
  Vec3 along;        // a unit vector
  double speed;      // [nm/ps]
  double k;          // [kJ/mol/nm²]
  Vec3 from{};       // where the atom was at the time `since` [nm]
  double since = 0;  // [ps]
};

// A field from outside that somebody else computes: a bias, a wall.
class OwnField {
 public:
  virtual ~OwnField() = default;
  virtual std::string name() const = 0;
  virtual double add(const Vectors& x, Vectors& f) = 0;  // f += F(x) [kJ/mol/nm]; its energy [kJ/mol]

  enum class Kind {
    kFromOutside,      // code that may throw anything, and forces that need not conserve the momentum
    kWithinMolecules,  // taut's own: depends on the shapes of molecules alone, and counts in the pressure
  };
  virtual Kind kind() const { return Kind::kFromOutside; }
};

// What pair forces are computed in. Mixed: geometry and force of a pair, and Ewald's mesh, in single
// precision, sums and the rest in double.
enum class Precision { kDouble, kMixed };

// All of a scene's forces. What is empty takes no time in a step.
struct Terms {
  std::vector<HarmonicBond> bonds{};
  std::vector<HarmonicAngle> angles{};
  std::vector<CosineAngle> cosine_angles{};
  std::vector<CosineSquaredAngle> cosine_squared_angles{};
  std::vector<RestrictedAngle> restricted_angles{};
  std::vector<TabulatedBond> tabulated_bonds{};
  std::vector<TabulatedAngle> tabulated_angles{};
  std::vector<PeriodicTorsion> torsions{};
  std::vector<RyckaertBellemans> rb_torsions{};
  std::vector<HarmonicTorsion> harmonic_torsions{};
  std::vector<BendingTorsion> bending_torsions{};
  std::vector<Eigen::MatrixXd> maps{};  // n x n: E at φ = 2π row/n, ψ = 2π column/n [kJ/mol]
  std::vector<CmapTorsion> cmaps{};
  std::vector<Fene> fene{};
  std::vector<FieldPair> field_pairs{};  // ForceField makes them where nonbonded->rf_excluded is
  std::optional<Nonbonded> nonbonded{};
  std::optional<Wca> wca{};
  std::optional<TabulatedPairs> tabulated_pairs{};
  std::optional<Vec3> gravity{};  // uniform acceleration [nm/ps²]
  std::vector<Pull> pulls{};
  Course pull_factor{};  // of all pulls [ps, 1]; empty: 1
  std::vector<Restraint> restraints{};
  std::vector<Wall> walls{};
  std::vector<SteeredAtom> steered{};
  std::vector<Bias> biases{};
  std::vector<std::shared_ptr<OwnField>> own{};
  Precision precision = Precision::kDouble;

  // True where forces of atoms that change in time do work; and where biases or those do.
  bool steered_in_time() const { return !steered.empty() || !pull_factor.empty(); }
  bool worked_in_time() const {
    for (const Bias& bias : biases)
      if (bias.rate != 0) return true;
    return steered_in_time();
  }
};

}  // namespace taut
