#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/aligned.hpp"
#include "forcefield/ewald/screening.hpp"
#include "forcefield/pairs/cluster_list.hpp"

namespace taut {

// How a pair's σ and ε follow from its atoms: one σ for all atoms that have ε, so that a pair needs √ε_i √ε_j
// alone; Lorentz and Berthelot's rule; a table by types.
enum class Mixing { kOneSigma, kTwoSigmas, kTable };

// The pair potential, in the conventions of OpenMM's NonbondedForce (no cutoff; cutoff with reaction field,
// in a periodic box or without one):
//     LJ:       4ε((σ/r)¹² − (σ/r)⁶) S(r),   σ = ½(σ_i + σ_j), ε = √(ε_i ε_j)   (Lorentz–Berthelot)
//     switch:   S = 1 − 6x⁵ + 15x⁴ − 10x³, x = (r − rs)/(rc − rs); 1 below rs
//     Coulomb:  k q_i q_j (1/r + k_rf r² − c_rf), k_rf = (ε−1)/((2ε+1)rc³), c_rf = 3ε/((2ε+1)rc)
//               (k is divided by what is between charges; Tironi et al. 1995, doi:10.1063/1.469273); without a cutoff both are zero
//     or        k q_i q_j erfc(αr)/r, Ewald's real space, by ewald/screening.hpp
//     WCA:      4ε((σ/r)¹² − (σ/r)⁶) + ε up to 2^(1/6)σ, its minimum, where energy and force reach zero
//               (Weeks, Chandler and Andersen 1971, doi:10.1063/1.1674820)
//     shifted: LJ less its value at the cutoff
//     LJ by a table: a/r¹² − b/r⁶, a and b of the atoms' types
// A pair interacts by what both its atoms have: Lennard-Jones, charge or both.
struct PairLaw {
  bool lj = false, charge = false;
  Mixing mixing = Mixing::kTwoSigmas;
  double sigma = 0;                                         // the one [nm]
  double types = 0;                                         // of the table: its lines are as long
  double energy_shift = 0;                                  // of a pair's energy, in units of ε: 1 for WCA
  double shift_inv_r6 = 0;                                  // rc⁻⁶ where LJ is shifted, else 0 [1/nm⁶]
  double cutoff = std::numeric_limits<double>::infinity();  // [nm]
  double switch_distance = std::numeric_limits<double>::infinity();  // [nm]
  double k_rf = 0, c_rf = 0;                                         // [1/nm³], [1/nm]
  Screening screening;                                               // with Ewald's sum

  bool switched() const { return lj && switch_distance < cutoff; }
  // What raises a pair's energy, in units of 4ε, where all have one σ.
  double raised() const {
    const double s6 = sigma6() * shift_inv_r6;
    return energy_shift / 4 + (s6 - s6 * s6);
  }
  double sigma6() const { return sigma * sigma * sigma * sigma * sigma * sigma; }
};

enum class Ask { kForces, kEnergy, kVirial };  // what a kernel sums over pairs

// The precision of pairs. Double: everything. Float: positions are 32-bit whole multiples of a unit of
// length, modulo 2³², so that differences of atoms within range are exact however large the system is. Their
// forces, and a lane's sum over its few tens of pairs, are in single precision; all further sums are in
// double.
template <class T>
struct PairPrecision;
template <>
struct PairPrecision<double> {
  using Coordinate = double;
  static Coordinate coordinate(double u) { return u; }
};
template <>
struct PairPrecision<float> {
  using Coordinate = std::int32_t;
  // The nearest whole number, for |u| < 2⁵¹, modulo 2³²: the sum has it in its low bits.
  static constexpr double kWholeInLowBits = 6755399441055744.0;
  static Coordinate coordinate(double u) {
    return static_cast<Coordinate>(std::bit_cast<std::int64_t>(u + kWholeInLowBits));
  }
};

// Atoms as the kernels read them, four to a cluster.
template <class T>
struct PairAtoms {
  Aligned<typename PairPrecision<T>::Coordinate> x;  // 12 a cluster: x of its four, y, z [unit]
  Aligned<T> charge;                                 // √k q [√(kJ/mol·nm)]
  Aligned<T> half_sigma;                             // [nm]
  Aligned<T> two_sqrt_epsilon;                       // [√(kJ/mol)]; 0 in fillers, as is the charge
  Aligned<T> type;                                   // a whole number
  Aligned<T> table_a, table_b;                       // [kJ/mol·nm¹², kJ/mol·nm⁶]
  double unit = 1;                                   // of x [nm]; 1 in double
};

// How many atoms a row has on this machine: 1, 2 or 4, as often as a vector holds a cluster's four atoms. The kernels keep
// as many copies of a cluster's forces, since each lane adds to a force of its own.
template <class T>
int row_atoms();

// The form of PairLaw::screening that this machine's kernels use.
template <class T>
ScreeningFit screening_fit();

// Adds the forces of a list's pairs to f [kJ/mol/nm/unit·nm]: 12·row_atoms() a cluster, x of all copies,
// y, z, copy by copy.
template <class T>
void add_pair_forces(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, T* f);

template <class T>
double pair_energy(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list);  // [kJ/mol]

// Σ r⊗f, the pairs' virial: xx, yy, zz, xy, xz, yz [kJ/mol].
using SixSums = std::array<double, 6>;
template <class T>
SixSums pair_virial(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list);

}  // namespace taut
