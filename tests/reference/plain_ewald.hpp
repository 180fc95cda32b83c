#pragma once

#include "plain_pairs.hpp"

namespace taut::tests {

// Coulomb of charges and all their periodic images, the surroundings a conductor (Ewald 1921,
// doi:10.1002/andp.19213690304), as it is written down: images and waves up to where erfc and exp are 1e-17.
//     ½ Σ_{ij,n}' k q q' erfc(αr)/r + ½ Σ_{m≠0} k exp(−π²m²/α²)/(πV m²) |Σ q e^(2πi m·x)|² − k α/√π Σ q²
//     − k πQ²/(2Vα²) − Σ_exceptions k q q'/r + exceptions by their own charges
// It depends on α by its rounding alone. Virial: −dE/dstrain. An excluded pair may be in one place:
// erfc(αr)/r − 1/r is −2α/√π there.
PairSums plain_ewald(const Nonbonded& nb, const Box& box, const Vectors& x, double alpha);

}  // namespace taut::tests
