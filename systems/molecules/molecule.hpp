#pragma once

#include <string>
#include <vector>

#include "systems/scene/scene.hpp"

namespace taut {

// The definition of a molecule: the lists of a scene for its own atoms, counted from 0.
struct Molecule {
  std::string name;
  System system;
  Terms terms;                  // nonbonded: charges, σ, ε and exceptions; none without pair forces
  std::vector<AtomKind> kinds;  // of each atom
  Vectors x;                    // its shape [nm]; if empty, one is drawn for every copy

  int atoms() const { return system.atoms(); }
};

// A tie between two atoms and its length: a rigid bond, a spring, a FENE spring (with its length between
// repulsive beads), a tabulated bond (with the length of its least energy), or a strut or rope if it is the only
// tie, with some slack.
struct Tie {
  int i, j;
  double length;       // [nm]
  double k = 0;        // of a harmonic spring [kJ/mol/nm²]
  bool slack = false;  // whether it is a strut or rope
};
std::vector<Tie> list_ties(const Molecule& molecule);

// The angle of least energy of three atoms: of harmonic ones, of harmonic ones in the cosine, and of tables.
struct Bend {
  int i, j, k;
  double angle;  // [rad]
};
std::vector<Bend> list_bends(const Molecule& molecule);

// Returns all pairs of atoms at most `most` bonds or springs apart.
struct NearPair {
  int i, j, apart;
};
std::vector<NearPair> list_near_pairs(const Molecule& molecule, int most);

struct Copies {
  const Molecule* of;
  int count;
};

// Builds a scene's system, terms and names from copies of molecules; each copy is a residue. External fields
// and the cutoff are left to the caller.
void assemble(const std::vector<Copies>& all, Scene& scene);

}  // namespace taut
