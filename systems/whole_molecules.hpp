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

// A virtual site belongs to its parents, and they to each other.
void tie_sites(const VirtualSites& sites, std::vector<BondedPair>& pairs);

// The rigid, harmonic and FENE bonds, and virtual sites: what makes atoms one molecule.
std::vector<BondedPair> bonded_pairs(const System& sys, const Terms& terms);

// The same with struts and ropes: what a change of the box must not draw apart.
std::vector<BondedPair> tied_pairs(const System& sys, const Terms& terms);

// What is drawn as bonds beside the rigid ones: springs, but for those between the ends of an angle, and
// FENE; a virtual site and its first parent.
std::vector<BondedPair> further_bonds(const System& sys, const Terms& terms);

// The molecule of each atom, numbered in the order of their first atoms.
std::vector<int> molecules(int atoms, const std::vector<BondedPair>& pairs);
std::vector<int> molecules(const System& sys, const Terms& terms);  // by tied_pairs

// Moves atoms by whole steps of the lattice until every bonded pair is its own nearest image. The first atom
// of each molecule stays, and so does a molecule that was whole. Without a box nothing moves. Linear time.
// Throws InputError for a molecule that is bonded to its own image: it can never be whole.
void make_whole(const Box& box, const std::vector<BondedPair>& pairs, Vectors& x);

// Names for a system of which no more is known than masses and bonds.
Names guessed_names(const System& sys, const Terms& terms);

}  // namespace taut
