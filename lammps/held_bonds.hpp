#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <type_traits>
#include <vector>

#include "lammps/keywords.hpp"
#include "lammps/lammps_headers.hpp"

namespace taut {

// What a held distance is: a bond, of a type; or the third side of an angle between two bonds.
struct HeldKind {
  int bond, other_bond = 0, angle = 0;  // types

  bool is_bond() const { return angle == 0; }
};

// One held distance, as the atom at one end of it knows it.
struct HeldBond {
  LAMMPS_NS::tagint partner;
  HeldKind kind;
  int freedom = 1;             // of the degree of freedom that it takes, so many halves are this atom's
  std::array<double, 3> past;  // multipliers of the last steps, newest first
  double told = 0;  // the newest multiplier: with a ghost, the one that its own processor has found
};

// The held bonds of every atom of this processor, its ghosts included: both atoms of a bond know it. They
// travel with their atoms between processors, to ghosts, and into restart files; the past of their
// multipliers goes with them.
class HeldBonds {
 public:
  explicit HeldBonds(const LAMMPS_NS::Atom& atom) : atom_(&atom) {}

  std::vector<HeldBond>& of(int i) { return held_[i]; }
  const std::vector<HeldBond>& of(int i) const { return held_[i]; }
  int count(int i) const { return static_cast<int>(held_[i].size()); }
  HeldBond* find(int i, LAMMPS_NS::tagint partner);
  // Of atom i's bonds to atoms of higher tags, the first: each bond is so counted with one of its atoms.
  int first_upward(int i) const;
  // Those of the atoms 0, 1, ...; `most` of one atom on any processor. Each atom's are sorted by partners.
  void assign(std::vector<std::vector<HeldBond>> held, int most, int room);
  int steps_known = 0;  // how many of the past count

  void grow(int room) { held_.resize(std::max<std::size_t>(held_.size(), room)); }
  void copy(int from, int to) { held_[to] = held_[from]; }
  void clear(int i) { held_[i].clear(); }
  int largest_pack() const { return 1 + kPacked * most_; }
  int packed(int i) const { return 1 + kPacked * count(i); }
  // True if a buffer of so many numbers can hold the bonds that it claims to hold.
  static bool fits(const double* buffer, int size) {
    return size == 1 + kPacked * static_cast<int>(buffer[0]);
  }
  int pack(int i, double* buffer) const;
  int unpack(int i, const double* buffer);  // returns how many numbers it took
  double memory_usage() const;              // [bytes]
  // Into what is held already: the past alone, of bonds that are in both.
  void unpack_past(int i, const double* buffer);

 private:
  // A bond travels as its bytes before `told`, so many numbers.
  static constexpr int kPacked = offsetof(HeldBond, told) / sizeof(double);
  static_assert(offsetof(HeldBond, told) % sizeof(double) == 0 && std::is_trivially_copyable_v<HeldBond>);

  const LAMMPS_NS::Atom* atom_;
  int most_ = 0;
  std::vector<std::vector<HeldBond>> held_;  // by atom
};

// What `selection` names among the atoms of the group, of all processors: each atom's own. A bond between two
// atoms of fixed_bits' group cannot change and is left out. Throws InputError.
std::vector<std::vector<HeldBond>> find_held_bonds(LAMMPS_NS::LAMMPS* lmp, const Selection& selection,
                                                   int groupbit, int fixed_bits);

// Changes the types of held bonds and angles (of these types) of this processor's atoms to negative ones,
// which no style counts, or back.
void set_type_signs(LAMMPS_NS::Atom& atom, const HeldBonds& held, const std::set<int>& angles, int sign);

// The lengths of held distances, by bond and angle styles. Throws InputError where a style has none.
class Lengths {
 public:
  explicit Lengths(const LAMMPS_NS::Force& force) : force_(&force) {}
  double operator()(const HeldKind& kind);  // [length]
  // Says which length is another now than it was when it was first asked for; empty: none is.
  std::string changed();

 private:
  double of_bond(int type);
  double find(const HeldKind& kind);

  const LAMMPS_NS::Force* force_;
  std::map<std::array<int, 3>, double> known_;
};

}  // namespace taut
