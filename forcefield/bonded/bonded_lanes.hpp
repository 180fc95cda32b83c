#pragma once

#include <array>
#include <span>

#include "forcefield/terms.hpp"

namespace taut {

// A PeriodicTorsion with its phase expanded, k(1 + cos φ₀ cos nφ + sin φ₀ sin nφ), so that a step computes no
// sine or cosine.
struct ExpandedTorsion {
  int i, j, k, l;
  double periodicity, amplitude, of_cosine, of_sine;  // n; k, k cos φ₀, k sin φ₀ [kJ/mol]

  explicit ExpandedTorsion(const PeriodicTorsion& t);
};

// A HarmonicTorsion with the cosine and sine of φ₀.
struct TurnedTorsion {
  int i, j, k, l;
  double stiffness, cosine, sine;

  explicit TurnedTorsion(const HarmonicTorsion& t);
};

inline std::array<int, 2> atoms_of(const HarmonicBond& t) {
  return {t.i, t.j};
}
inline std::array<int, 2> atoms_of(const Fene& t) {
  return {t.i, t.j};
}
inline std::array<int, 2> atoms_of(const PairException& t) {
  return {t.i, t.j};
}
inline std::array<int, 3> atoms_of(const HarmonicAngle& t) {
  return {t.i, t.j, t.k};
}
inline std::array<int, 3> atoms_of(const CosineAngle& t) {
  return {t.i, t.j, t.k};
}
inline std::array<int, 3> atoms_of(const CosineSquaredAngle& t) {
  return {t.i, t.j, t.k};
}
inline std::array<int, 4> atoms_of(const ExpandedTorsion& t) {
  return {t.i, t.j, t.k, t.l};
}
inline std::array<int, 4> atoms_of(const TurnedTorsion& t) {
  return {t.i, t.j, t.k, t.l};
}
inline std::array<int, 4> atoms_of(const RyckaertBellemans& t) {
  return {t.i, t.j, t.k, t.l};
}

// Each function adds the forces of its terms to f and returns their energy [kJ/mol], one term a lane of a
// vector. Molecules are whole in x, so separations are plain differences. Where an end atom of a torsion lies
// on the torsion's axis, all forces of the torsion are zero and φ counts as 0.
double add_term_forces(std::span<const HarmonicBond> bonds, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const HarmonicAngle> angles, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const CosineAngle> angles, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const CosineSquaredAngle> angles, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const ExpandedTorsion> torsions, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const RyckaertBellemans> torsions, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const TurnedTorsion> torsions, const Vectors& x, Vectors& f);
double add_term_forces(std::span<const Fene> bonds, const Vectors& x,
                       Vectors& f);  // NaN where a bond is broken
double add_term_forces(std::span<const PairException> exceptions, const Vectors& x, Vectors& f);

}  // namespace taut
