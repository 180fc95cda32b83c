#pragma once

#include <span>
#include <vector>

#include "forcefield/bonded/pieces.hpp"
#include "forcefield/ewald/mesh.hpp"
#include "forcefield/ewald/screening.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/system.hpp"

namespace taut {

// Coulomb interaction of all periodic images, but for pairs within the cutoff (Ewald 1921; Essmann et al.
// 1995, doi:10.1063/1.470117), in OpenMM's conventions:
//     the reciprocal part, on a mesh
//     self:        −k α/√π Σ q²
//     background:  −k π Q²/(2Vα²), Q = Σ q: a uniform charge that neutralizes the box
//     exceptions:  −k q q' erf(αr)/r of every pair left out of the general sum, which the mesh has in it
// The pairs' own part, k q q' erfc(αr)/r, is one of the laws of pairs/pair_kernels.hpp.
class Pme {
 public:
  // nb.pme as chosen. reach: exceptions of molecules that meet their own image are of nearest images.
  Pme(const Nonbonded& nb, Precision precision, std::vector<Reach> reach = {});

  void set_box(const Box& box);
  double add_forces(const Vectors& x, Vectors& f);  // returns the energy [kJ/mol]
  // −dE/dstrain at x [kJ/mol], computed anew.
  Eigen::Matrix3d virial(const Vectors& x);

 private:
  struct Excluded {
    int i, j;
    double qq;  // k q q' [kJ/mol·nm]
  };

  struct ExcludedSums {
    double energy = 0;                                 // [kJ/mol]
    Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();  // Σ r⊗f

    ExcludedSums& operator+=(const ExcludedSums& more) {
      energy += more.energy;
      virial += more.virial;
      return *this;
    }
    friend ExcludedSums operator+(ExcludedSums a, const ExcludedSums& b) { return a += b; }
  };

  struct Screened {
    Vec3 r;
    double energy, force;  // as those of ScreenedPairs
  };

  // add(sums, excluded, screened) for every pair, at x.
  ExcludedSums over_excluded(const Vectors& x, const auto& add);
  ExcludedSums over_some(std::span<const Excluded> excluded, const Vectors& x, const auto& add) const;

  double alpha_;  // [1/nm]
  Screening screening_;
  std::vector<Reach> reach_;
  Box box_;
  double total_;  // Q [e]
  double constant_, background_ = 0;
  double coulomb_;  // [kJ/mol·nm/e²]
  std::vector<Excluded> excluded_;
  Pieces cuts_;
  std::vector<int> start_;  // of its pieces in excluded_
  std::vector<ExcludedSums> sum_of_;
  PmeMesh mesh_;
};

}  // namespace taut
