#pragma once

#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "forcefield/bonded/bonded_lanes.hpp"
#include "forcefield/bonded/cmap.hpp"
#include "forcefield/bonded/pieces.hpp"
#include "forcefield/bonded/tabulated.hpp"

namespace taut {

// All forces between atoms that are neighbours along a molecule, exceptions included, computed by threads.
// Terms are sorted by their atoms and cut into pieces (pieces.hpp). The sums are the same bits on any number of threads.
class BondedForces {
 public:
  BondedForces() = default;
  BondedForces(const Terms& terms, const std::vector<PairException>& exceptions);

  // Energies by kind of term, in the order of kinds_ [kJ/mol].
  using KindEnergies = std::array<double, 15>;
  // Throws SimulationFailure where a fene bond is stretched to r₀ or more, and outside a table.
  KindEnergies add_forces(const Vectors& x, Vectors& f);

  using KindCounts = std::array<std::size_t, 15>;
  KindCounts counts() const;  // of terms

  // Energies by name, exceptions and the field of excluded charges left out, only the kinds there are: ("angle", 12.3), ...
  static std::vector<std::pair<std::string, double>> by_name(const KindEnergies& energies,
                                                             const KindCounts& counts);
  static double exception_energy(const KindEnergies& energies) {
    return energies.back() + energies[energies.size() - 2];
  }

  const Pieces& pieces() const { return pieces_; }

 private:
  template <class Term>
  struct Sorted {
    std::vector<Term> terms;
    std::vector<int> start;      // pieces + 1: each piece's first term
    std::vector<double> energy;  // of each piece [kJ/mol]

    double total() const;
  };

  void sort_and_cut();

  std::tuple<Sorted<HarmonicBond>, Sorted<HarmonicAngle>, Sorted<CosineAngle>, Sorted<ExpandedTorsion>,
             Sorted<RyckaertBellemans>, Sorted<TurnedTorsion>, Sorted<CmapPair>, Sorted<Fene>,
             Sorted<CosineSquaredAngle>, Sorted<TabulatedBond>, Sorted<TabulatedAngle>,
             Sorted<RestrictedAngle>, Sorted<BendingTorsion>, Sorted<FieldPair>, Sorted<PairException>>
      kinds_;
  Pieces pieces_;
};

}  // namespace taut
