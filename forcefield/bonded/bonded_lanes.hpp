#pragma once

#include <span>
#include <variant>

#include "forcefield/term_lists.hpp"

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

// Terms of one kind.
using TermSpan =
    std::variant<std::span<const HarmonicBond>, std::span<const Fene>, std::span<const PairException>,
                 std::span<const HarmonicAngle>, std::span<const CosineAngle>,
                 std::span<const CosineSquaredAngle>, std::span<const RestrictedAngle>,
                 std::span<const ExpandedTorsion>, std::span<const RyckaertBellemans>,
                 std::span<const TurnedTorsion>, std::span<const BendingTorsion>, std::span<const FieldPair>>;

// Adds the forces of the terms to f and returns their energy [kJ/mol], one term a lane of a vector; NaN where a FENE bond
// is broken. Molecules are whole in x, so separations are plain differences. Where an end atom of a torsion lies on the
// torsion's axis, all forces of the torsion are zero and φ counts as 0.
double add_term_forces(const TermSpan& terms, const Vectors& x, Vectors& f);

}  // namespace taut
