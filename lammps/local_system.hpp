#pragma once

#include <array>
#include <vector>

#include "lammps/held_bonds.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// An atom of this processor or a ghost, moved by whole box vectors to where its cluster is.
struct Image {
  int atom;  // as LAMMPS numbers them
  std::array<int, 3> vectors;
};

// A bond next to the last one solved here. Its multiplier of the step before, as the processor finds it that
// owns its atom of the lower tag, comes with that atom, a ghost here, in the forward communication.
struct OuterBond {
  int inner;       // its atom that is in the system
  Image outer;     // and the other
  HeldBond* held;  // as that ghost knows it
};

// A cluster that goes on beyond what is solved here: its bonds and outer bonds.
struct CutCluster {
  int first_bond, end_bond, first_outer, end_outer;
};

// How an atom's image was found: beside that of an atom it is bonded to; less than 0: the first of its
// cluster.
struct FoundBeside {
  int image, known;
};

// The part of the system that one processor solves: all bonds of its own atoms, and those within `overlap` bonds of
// them whose neighbours along the chain are all known here. Smaller clusters are whole. The atoms of a cluster follow
// each other in the order of their tags, so that every processor that has the cluster does the same sums.
struct LocalSystem {
  System system;
  std::vector<Image> images;                     // of the system's atoms
  std::vector<std::array<HeldBond*, 2>> places;  // of the system's bonds: what their atoms know
  std::vector<std::array<int, 2>> slots;         // of these among their atoms' bonds
  std::vector<OuterBond> outer;
  // Bonds between an atom of this processor and a ghost of lower tag, their i: two processors find their
  // multipliers, and that of the other comes with the ghost.
  std::vector<int> shared;
  // Bonds whose multipliers other processors are told, with their atom of the lower tag, and those that are shared.
  std::vector<std::pair<int, HeldBond*>> told;
  std::vector<CutCluster> cut;
  bool ghosts = false;  // one of the atoms is a ghost

  // To find the same again where atoms have other numbers.
  std::vector<LAMMPS_NS::tagint> tags;  // of the images' atoms
  std::vector<char> own;                // whether they are this processor's
  std::vector<FoundBeside> path;        // through each cluster
};

// An atom that is held to one known here, but is not known here itself.
struct MissingAtom {
  static constexpr int kNone = 1 << 20;
  int depth = kNone;  // bonds from the nearest atom that is this processor's own
  LAMMPS_NS::tagint partner = 0, atom = 0;
};

class LocalSystemFinder {
 public:
  // fixed_bits: the group of atoms that have no finite mass.
  LocalSystemFinder(LAMMPS_NS::LAMMPS* lmp, HeldBonds& held, Lengths& lengths, int fixed_bits)
      : lmp_(lmp), held_(held), lengths_(lengths), fixed_bits_(fixed_bits) {}

  // Looks as many bonds as `limit` beyond this processor's own atoms. Returns the nearest atom that is not
  // known.
  MissingAtom find_depths(int limit);

  // After find_depths(limit), limit ≥ overlap + 2, and nothing unknown nearer than 3 bonds: the neighbours of
  // the outermost bond beyond its own atoms.
  LocalSystem find(int overlap);

  // Returns whether this processor's atoms are those for which `local` was found, whole clusters all: then they are
  // the same, and only know their atoms by new numbers.
  bool find_again(LocalSystem& local) const;

 private:
  int index_of(LAMMPS_NS::tagint tag) const { return lmp_->atom->map(tag); }
  void collect_cluster(int first, int overlap);
  void add_atoms(LocalSystem& local);
  void add_bonds(int overlap, LocalSystem& local);
  Image image_beside(const Image& known, int atom) const;
  bool solved(int a, int b, int overlap) const {
    return complete_[a] && complete_[b] && std::min(depth_[a], depth_[b]) <= overlap;
  }

  LAMMPS_NS::LAMMPS* lmp_;
  HeldBonds& held_;
  Lengths& lengths_;
  int fixed_bits_;
  std::vector<int> depth_;      // bonds from the nearest own atom; −1: none, or too many
  std::vector<char> complete_;  // atoms nearer than find_depths' limit whose partners are all known
  std::vector<int> number_;     // in the system; −1: not yet
  std::vector<int> order_;
  std::vector<Image> cluster_;
  std::vector<std::array<int, 2>> path_;  // of the cluster: atom, and the one it was found beside
};

}  // namespace taut
