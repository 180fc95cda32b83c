#pragma once

#include <array>
#include <vector>

#include "base/names.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/system.hpp"

namespace taut {

// Two atoms that belong to one molecule.
using BondedPair = std::array<int, 2>;

// Appends the pairs of each virtual site and its parents, and of the parents.
void tie_sites(const VirtualSites& sites, std::vector<BondedPair>& pairs);

// Returns the pairs that make atoms one molecule: rigid, harmonic, FENE and tabulated bonds, and virtual sites.
std::vector<BondedPair> bonded_pairs(const System& sys, const Terms& terms);

// The same with struts and ropes, whose atoms a barostat must move together.
std::vector<BondedPair> tied_pairs(const System& sys, const Terms& terms);

// Returns the pairs that are drawn as bonds besides the rigid ones: springs (except between the ends of an
// angle), FENE bonds, and virtual sites with their first parents.
std::vector<BondedPair> further_bonds(const System& sys, const Terms& terms);

// Returns the molecule of each atom; molecules are numbered in the order of their first atoms.
std::vector<int> molecules(int atoms, const std::vector<BondedPair>& pairs);
std::vector<int> molecules(const System& sys, const Terms& terms);  // from tied_pairs()

// Moves atoms by lattice vectors so that the atoms of every bonded pair are nearest images. The first atom of
// each molecule stays, as does a molecule that is whole already. Without a box nothing moves. The time is
// linear. Throws InputError for a molecule that is bonded to its own image, which cannot be made whole.
void make_whole(const Box& box, const std::vector<BondedPair>& pairs, Vectors& x);

// Returns names for a system of which only masses and bonds are known.
Names guessed_names(const System& sys, const Terms& terms);

}  // namespace taut
