#pragma once

#include <string>
#include <vector>

#include "systems/scene.hpp"

namespace taut {

// A molecule said once: the lists that a scene has, of its own atoms from 0 on.
struct Molecule {
  std::string name;
  System system;
  Terms terms;                  // nonbonded: charges, σ, ε and exceptions; none where no pair force acts
  std::vector<AtomKind> kinds;  // of each atom
  Vectors x;                    // its shape [nm]; empty: one is drawn for every copy

  int atoms() const { return system.atoms(); }
};

// The rigid bonds and springs, and how long they are; a FENE spring, as long as among repulsive beads; a
// strut or rope where nothing else ties what it joins, not quite touching.
struct Tie {
  int i, j;
  double length;       // [nm]
  double k = 0;        // of a harmonic spring [kJ/mol/nm²]
  bool slack = false;  // a strut or rope
};
std::vector<Tie> ties(const Molecule& molecule);

// All pairs of atoms that are at most `most` bonds and springs apart, by their atoms.
struct NearPair {
  int i, j, apart;
};
std::vector<NearPair> near_pairs(const Molecule& molecule, int most);

struct Copies {
  const Molecule* of;
  int count;
};

// Copies behind one another: the scene's system, terms and names, each copy a residue. Fields, and how pairs
// are cut off, are left to the caller.
void put_together(const std::vector<Copies>& all, Scene& scene);

}  // namespace taut
