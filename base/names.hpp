#pragma once

#include <string>
#include <tuple>
#include <vector>

namespace taut {

// Names of atoms, for files that other programs read. No result depends on them.
struct AtomKind {
  std::string atom, residue;  // "OW" in "HOH"
  std::string element;        // "O"; empty for a group of atoms or a bead

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

// The names of `copies` copies of one molecule; each copy is a residue.
Names repeated_names(const std::vector<AtomKind>& molecule, int copies);

// Guesses names from masses and molecules. An atom's element is the one of its mass (to 0.006 u, else a bead
// "X"), its name the element with its count in the molecule: "C1", "C2", "H1". A water is HOH, any other
// molecule MOL.
Names guessed_names(const std::vector<double>& mass, const std::vector<int>& molecule);

}  // namespace taut
