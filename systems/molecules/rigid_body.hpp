#pragma once

#include "systems/molecules/molecule.hpp"
#include "systems/molecules/rows.hpp"

namespace taut {

// The name of the points that carry the mass of a rigid body. They have no pair force.
inline constexpr const char* kFrameAtom = "FRM";

// Reads virtual_sites2, virtual_sites3 and virtual_sites3out, GROMACS's virtual sites, of atoms with these
// masses. A site has mass 0.
VirtualSites read_sites(RowReader& rows, const Eigen::VectorXd& mass);

// Makes a molecule with coordinates rigid. Point masses that rigid bonds hold are appended to its atoms, and
// every atom becomes a massless virtual site of theirs. With the mass M, the centre of mass c and the second
// moments S = Σ m (x − c)(x − c)ᵀ of the atoms, S = Σ_d S_d e_d e_dᵀ, the points are at
//     c ± √(S₁/M) e₁                                      two of mass M/2, for atoms in a line,
//     c + √2 (√(S₁/M) cos φ e₁ + √(S₂/M) sin φ e₂)        three of mass M/3, φ = 0°, 120°, 240°, in a plane,
//     c + Σ_d √(S_d/M) t_d e_d                            four of mass M/4, t the corners (1, 1, 1),
//                                                         (1, −1, −1), (−1, 1, −1), (−1, −1, 1) of a cube.
// They have the same M, c and S, hence the same tensor of inertia tr(S) 1 − S. Atoms that leave a line or a
// plane by less than 0.002 of the body's length are put into it. All pairs of atoms are excluded. Throws
// InputError for a body without mass or extent.
void make_rigid(Molecule& molecule);

}  // namespace taut
