#pragma once

#include <array>
#include <map>
#include <span>
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
  std::array<double, 3> past;  // multipliers of the last steps, newest first
};

// The held bonds of every atom of this processor, its ghosts included: both atoms of a bond know it. They
// travel with their atoms between processors, to ghosts, and into restart files; the past of their
// multipliers goes with them.
class HeldBonds {
 public:
  explicit HeldBonds(const LAMMPS_NS::Atom& atom) : atom_(&atom) {}

  std::span<HeldBond> of(int i) { return {&held_[std::size_t(i) * most_], std::size_t(count_[i])}; }
  std::span<const HeldBond> of(int i) const {
    return {&held_[std::size_t(i) * most_], std::size_t(count_[i])};
  }
  int count(int i) const { return count_[i]; }
  HeldBond* find(int i, LAMMPS_NS::tagint partner);
  // Of atom i's bonds to atoms of higher tags, the first: each bond is so counted with one of its atoms.
  int first_upward(int i) const;
  // Those of the atoms 0, 1, ..., sorted by partners; `most` of one atom on any processor.
  void assign(const std::vector<std::vector<HeldBond>>& held, int most, int room);
  int most() const { return most_; }
  int steps_known = 0;  // how many of the past count

  void grow(int room);
  void copy(int from, int to);
  void clear(int i) { count_[i] = 0; }
  int largest_pack() const { return 1 + kPacked * most_; }
  int packed(int i) const { return 1 + kPacked * count_[i]; }
  int pack(int i, double* buffer) const;
  int unpack(int i, const double* buffer);  // returns how many numbers it took
  double memory_usage() const { return static_cast<double>(held_.capacity() * sizeof(HeldBond)); }
  // Into what is held already: the past alone, of bonds that are in both.
  void unpack_past(int i, const double* buffer);

 private:
  // Among numbers that travel a bond is so many of them, of the same bytes.
  static constexpr int kPacked = sizeof(HeldBond) / sizeof(double);
  static_assert(sizeof(HeldBond) % sizeof(double) == 0 && std::is_trivially_copyable_v<HeldBond>);

  const LAMMPS_NS::Atom* atom_;
  int most_ = 0;
  std::vector<int> count_;
  std::vector<HeldBond> held_;  // [atom][most_]
};

// What `selection` names among the atoms of the group, of all processors: each atom's own. Throws InputError.
std::vector<std::vector<HeldBond>> find_held_bonds(LAMMPS_NS::LAMMPS* lmp, const Selection& selection,
                                                   int groupbit);

// Changes the types of held bonds and angles (of these types) of this processor's atoms to negative ones,
// which no style counts, or back.
void set_type_signs(LAMMPS_NS::Atom& atom, const HeldBonds& held, const std::set<int>& angles, int sign);

// The lengths of held distances, by bond and angle styles. Throws InputError where a style has none.
class Lengths {
 public:
  explicit Lengths(const LAMMPS_NS::Force& force) : force_(&force) {}
  double operator()(const HeldKind& kind);  // [length]

 private:
  double of_bond(int type);
  double find(const HeldKind& kind);

  const LAMMPS_NS::Force* force_;
  std::map<std::array<int, 3>, double> known_;
};

}  // namespace taut
