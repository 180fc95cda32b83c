#pragma once

#include <string>
#include <tuple>
#include <vector>

namespace taut {

// What atoms are called, for files that others read. Nothing is computed from it.
struct AtomKind {
  std::string atom, residue;  // "OW" in "HOH"
  std::string element;        // "O"; empty where it stands for a group or a bead

  friend bool operator<(const AtomKind& a, const AtomKind& b) {
    return std::tie(a.atom, a.residue, a.element) < std::tie(b.atom, b.residue, b.element);
  }
};

struct Names {
  std::vector<AtomKind> kinds;
  std::vector<int> kind;     // of each atom, an index into kinds
  std::vector<int> residue;  // of each atom, residues counted from 0

  bool empty() const { return kind.empty(); }
};

// Copies of one molecule, atom by atom; each is a residue.
Names repeated_names(const std::vector<AtomKind>& molecule, int copies);

// Of atoms of which the masses and the molecules are known alone: the element is the one of that mass (to
// 0.006 u, else a bead "X"), the name the element with its count in the molecule, "C1", "C2", "H1", ...
// Three-site water is HOH, any other molecule MOL.
Names guessed_names(const std::vector<double>& mass, const std::vector<int>& molecule);

}  // namespace taut
