#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "forcefield/bonded/bonded_lanes.hpp"
#include "forcefield/bonded/cmap.hpp"

namespace taut {

// All forces between atoms that are neighbours along a molecule, exceptions included, by threads. Terms are
// sorted by their atoms and cut into pieces where no term reaches across, mostly between molecules. So no two
// pieces share an atom, and the sums are the same bits on any number of threads.
class BondedForces {
 public:
  BondedForces() = default;
  BondedForces(const Terms& terms, const std::vector<PairException>& exceptions);

  // Throws SimulationFailure where a fene bond is stretched to its reach or more.
  void add_forces(const Vectors& x, Vectors& f);

  // Of the last evaluation [kJ/mol], in the order of bonded.hpp, only what there is: ("angle", 12.3), ...
  std::vector<std::pair<std::string, double>> energies() const;
  double exception_energy() const;

  int pieces() const { return pieces_; }

 private:
  template <class Term>
  struct Sorted {
    std::vector<Term> terms;
    std::vector<int> start;      // pieces + 1: each piece's first term
    std::vector<double> energy;  // of each piece [kJ/mol]

    double total() const;
  };

  void sort_and_cut();

  std::tuple<Sorted<HarmonicBond>, Sorted<HarmonicAngle>, Sorted<ExpandedTorsion>, Sorted<RyckaertBellemans>,
             Sorted<TurnedTorsion>, Sorted<CmapPair>, Sorted<Fene>, Sorted<PairException>>
      kinds_;
  int pieces_ = 0;
  int terms_ = 0;
};

}  // namespace taut
