#pragma once

#include <array>
#include <vector>

#include "base/names.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Two atoms that belong to one molecule.
using BondedPair = std::array<int, 2>;

// Two atoms of one molecule, and what keeps them together or apart.
struct Tether {
  enum class By { kBond, kSpring, kStrut, kRope, kSite };
  int i, j;
  By by;
  double length = 0;  // of a rigid bond or a strut, or of a spring at rest [nm]; 0: not known
};

// Appends those of springs, and FENE and tabulated bonds; of each virtual site with a parent, and of its parents.
void add_tethers(const Terms& terms, std::vector<Tether>& tethers);
void add_tethers(const VirtualSites& sites, std::vector<Tether>& tethers);
std::vector<Tether> tethers(const System& sys, const Terms& terms);
std::vector<BondedPair> pairs_of(const std::vector<Tether>& tethers);

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

// Moves atoms by lattice vectors so that molecules are whole. The first atom of each stays, as does a molecule that is
// whole already. Without a box nothing moves. A molecule that is bonded to its own image cannot be made whole: its
// clusters are, or where a cluster meets its own image, virtual sites with their parents. Returns which do; empty: none.
// The two atoms of a tether become
// - nearest images, where it is no longer than half the box's shortest edge, or of no known length;
// - else images at its length: as they are, if they are so to 1 % or no image is nearer to it; or those that are.
// Surer tethers come first, and those of struts, ropes and sites decide only where nothing else does. Throws InputError
// for a rigid bond longer than half the box that no image fits, or two alike, and for a tether of such a length in a
// molecule that is bonded to its own image, where bonds are of nearest images.
std::vector<Reach> make_whole(const Box& box, const std::vector<Tether>& tethers, Vectors& x);
// The same, and tells the system.
void make_whole(const std::vector<Tether>& tethers, State& start, System& sys);

// Returns why positions are taken for ones in ångström: bonds are ten times as long as they are held, or as their springs
// are at rest, half of all between 8 and 12.5 times. Nothing where they are not. Springs are judged from three on.
std::string angstrom_doubt(const std::vector<RigidBond>& bonds, const std::vector<HarmonicBond>& springs,
                           const Vectors& x);

// Returns names for a system of which only masses and bonds are known.
Names guessed_names(const System& sys, const Terms& terms);

}  // namespace taut
