#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "md/vectors.hpp"

namespace taut {

// Pairs of atoms to sum over, each once, in rows: an atom and its partners.
struct PairList {
  struct Row {
    int atom;
    int begin, end;  // its partners: partners[begin] .. partners[end - 1]
    Vec3 shift;      // whole box edges: the partners are met at x_j + shift [nm]
  };
  std::vector<Row> rows;
  std::vector<int> partners;

  void clear() {
    rows.clear();
    partners.clear();
  }
};

inline constexpr int kPairKinds = 4;
using PairLists = std::array<PairList, kPairKinds>;  // by kind; [0] stays empty

// Which pairs interact, and by what.
struct PairRules {
  std::vector<std::uint8_t> kind;  // n; two bits. A pair's kind is what its atoms share: 0, no interaction
  std::vector<std::array<int, 2>> exclusions;  // pairs that do not interact
};

// Sorts an atom's candidates into the lists of their kinds, without its exclusions.
class PairSorter {
 public:
  explicit PairSorter(const PairRules& rules);

  struct Candidates {
    int atom;
    const int* partners;
    int count;
    Vec3 shift = Vec3::Zero();
  };
  // Adds a row for the atom to every list where it has partners.
  void add_row(const Candidates& candidates, PairLists& lists);
  bool interacts(int atom) const { return kind_[atom] != 0; }

 private:
  std::vector<std::uint8_t> kind_;   // n
  std::vector<int> excluded_begin_;  // n + 1
  std::vector<int> excluded_;        // partners of atom a: excluded_begin_[a] ..
  std::vector<int> excluded_from_;   // n: the last atom that ruled this one out
};

}  // namespace taut
