#pragma once

#include <memory>

#include "base/archive.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

struct PairProblem;

// The pair forces of a scene (pair_kernels.hpp has the equations), in SIMD vectors over clusters of atoms
// that are sorted in space, computed by threads. Exceptions with parameters of their own are not in them.
//
// Two lists, as GROMACS has them (Páll et al. 2020, doi:10.1063/5.0018516). The outer one, from a search,
// holds the clusters within cutoff + outer buffer. The inner one is pruned from it: the clusters that can
// come within the cutoff while each atom stays within a margin of its expected position (AtomTracks). Forces
// are summed over the inner list as long as all atoms do. It is pruned anew from the outer list while the
// expected positions are within half the outer buffer of those of the search; else the search is repeated. So
// no pair within the cutoff is ever missed. The lists and the number of threads fix the order of all sums.
class ClusterPairs {
 public:
  ClusterPairs(const Nonbonded& nb, bool periodic, Precision precision);
  ClusterPairs(const Wca& wca, int atoms, bool periodic, Precision precision);
  ClusterPairs(const TabulatedPairs& pairs, bool periodic, Precision precision);
  ~ClusterPairs();
  ClusterPairs(ClusterPairs&&) noexcept;
  ClusterPairs& operator=(ClusterPairs&&) noexcept;

  enum class Write { kAdd, kOverwrite };  // overwriting sets only the forces of atoms that have pairs
  bool on_every_atom() const { return on_every_atom_; }
  // Takes the positions and renews the lists where they no longer cover them. Throws SimulationFailure for a
  // position that is not finite or absurd (check_positions.hpp): of any atom when lists are made, of atoms
  // that have pairs at any time. A changed box makes new lists. Its shortest edge must be at least twice the
  // cutoff. What hear() throws in a search leaves no list, and the next call searches again.
  void update_lists(const Vectors& x, const Box& box);
  // The next three are at the positions of the last update_lists(). Forces and virial throw SimulationFailure where
  // two atoms are nearer to each other than their table begins; the energy is infinite.
  void add_forces(Vectors& f, Write write = Write::kAdd);
  void add_forces(const Vectors& x, const Box& box, Vectors& f) {
    update_lists(x, box);
    add_forces(f);
  }
  double energy();           // [kJ/mol]
  Eigen::Matrix3d virial();  // Σ r⊗f

  void serialize(Archive& archive);  // the positions of the last search; loading repeats it there

  long searches() const;  // for the outer list, so far
  long prunings() const;  // to the inner one

  class Engine;  // one for each precision

 private:
  ClusterPairs(const PairProblem& problem, Precision precision);

  std::unique_ptr<Engine> engine_;
  bool on_every_atom_ = false;
};

}  // namespace taut
