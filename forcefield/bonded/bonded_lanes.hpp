#pragma once

#include <array>
#include <span>

#include "forcefield/terms.hpp"

namespace taut {

// A PeriodicTorsion with its phase expanded, k(1 + cos φ₀ cos nφ + sin φ₀ sin nφ): so that a step takes no
// sine or cosine.
struct ExpandedTorsion {
  int i, j, k, l;
  double periodicity, amplitude, of_cosine, of_sine;  // n; k, k cos φ₀, k sin φ₀ [kJ/mol]

  explicit ExpandedTorsion(const PeriodicTorsion& t);
};

// A HarmonicTorsion with φ₀'s cosine and sine.
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
inline std::array<int, 4> atoms_of(const ExpandedTorsion& t) {
  return {t.i, t.j, t.k, t.l};
}
inline std::array<int, 4> atoms_of(const TurnedTorsion& t) {
  return {t.i, t.j, t.k, t.l};
}
inline std::array<int, 4> atoms_of(const RyckaertBellemans& t) {
  return {t.i, t.j, t.k, t.l};
}

// The sums of bonded.hpp and exceptions.hpp (which have the mathematics), one term a lane of a vector: each
// adds its forces to f and returns its energy [kJ/mol]. They take no sines of torsions. Where an end of a
// torsion lies on its axis, all of the torsion's forces are zero and φ counts as 0.
double add_in_lanes(std::span<const HarmonicBond> bonds, const Vectors& x, Vectors& f);
double add_in_lanes(std::span<const HarmonicAngle> angles, const Vectors& x, Vectors& f);
double add_in_lanes(std::span<const ExpandedTorsion> torsions, const Vectors& x, Vectors& f);
double add_in_lanes(std::span<const RyckaertBellemans> torsions, const Vectors& x, Vectors& f);
double add_in_lanes(std::span<const TurnedTorsion> torsions, const Vectors& x, Vectors& f);
double add_in_lanes(std::span<const Fene> bonds, const Vectors& x, Vectors& f);  // NaN where one is broken
double add_in_lanes(std::span<const PairException> exceptions, const Vectors& x, Vectors& f);

}  // namespace taut
