#pragma once

#include <optional>
#include <vector>

#include "forcefield/neighbour_list.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// Lennard-Jones and Coulomb between all atoms but the exceptions, in the conventions of OpenMM's
// NonbondedForce (no cutoff; cutoff with reaction field, in a periodic box or without one).
//     LJ:       4ε((σ/r)¹² − (σ/r)⁶) S(r),   σ = ½(σ_i + σ_j), ε = √(ε_i ε_j)   (Lorentz–Berthelot)
//     switch:   S = 1 − 6x⁵ + 15x⁴ − 10x³, x = (r − rs)/(rc − rs); 1 below rs
//     Coulomb:  k q_i q_j (1/r + k_rf r² − c_rf), k_rf = (ε−1)/((2ε+1)rc³), c_rf = 3ε/((2ε+1)rc)
//               (Tironi et al. 1995, doi:10.1063/1.469273); without a cutoff both are zero
// Exceptions: their own numbers, plain 1/r, no cutoff and no images.
// A pair is summed for what both its atoms have, Lennard-Jones, charge or both; with neither it is not
// even listed.
class LennardJonesCoulomb {
 public:
  struct Atom {
    double charge;            // √k q [√(kJ/mol·nm)]
    double half_sigma;        // [nm]
    double two_sqrt_epsilon;  // [√(kJ/mol)]
  };
  struct Numbers {
    double cutoff, switch_distance;  // [nm]; infinity: none
    double k_rf = 0, c_rf = 0;       // [1/nm³], [1/nm]
  };

  LennardJonesCoulomb(const Nonbonded& nb, const Box& box);

  double add(const Vectors& x, Vectors& f);  // energy [kJ/mol]

 private:
  enum Kind { kLj = 1, kCharge = 2, kBoth = kLj | kCharge };

  static PairRules rules(const Nonbonded& nb);
  double add_listed(const PairLists& lists, const Vectors& x, Vectors& f) const;
  template <int kind>
  double add_kind(const PairList& list, const Vectors& x, Vectors& f) const;
  template <class Law>
  double add_law(Law law, const PairList& list, const Vectors& x, Vectors& f) const;
  double add_all(const Vectors& x, Vectors& f);

  std::vector<Atom> atoms_;
  std::vector<PairException> exceptions_;  // those that interact
  Box box_;
  Numbers numbers_;
  std::optional<NeighbourList> list_;  // with a cutoff
  PairSorter sorter_;                  // without one: rows are sorted as they are summed
  PairLists row_;
  std::vector<int> everyone_;
};

}  // namespace taut
