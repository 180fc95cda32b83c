#pragma once

#include <memory>

#include "base/archive.hpp"
#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

struct PairProblem;

// The pair forces of a scene (pair_kernels.hpp has the equations), in vectors over clusters of atoms sorted
// in space, by threads. What exceptions add by their own numbers is not in them.
//
// Two lists, as GROMACS has them (Páll et al. 2020, doi:10.1063/5.0018516). The outer one, from a search,
// holds the clusters within cutoff + outer buffer; the inner one, what of it can come within the cutoff while
// each atom stays near where it is to be expected (AtomTracks). Forces are summed over the inner one while
// all do; it is made again from the outer one while what is expected is within half the outer buffer of where
// the atoms were searched. So no pair within the cutoff is ever missed. The order of all sums is fixed by the
// lists and the number of threads.
class ClusterPairs {
 public:
  ClusterPairs(const Nonbonded& nb, bool periodic, Precision precision);
  ClusterPairs(const Wca& wca, int atoms, bool periodic, Precision precision);
  ~ClusterPairs();
  ClusterPairs(ClusterPairs&&) noexcept;
  ClusterPairs& operator=(ClusterPairs&&) noexcept;

  enum class Onto { kWhatIs, kNothing };  // of f; nothing, whatever it was, only where pairs act
  bool on_every_atom() const { return on_every_atom_; }
  // Lists that serve atoms where they are now. Throws SimulationFailure for a position that is not finite or
  // absurd (check_positions.hpp), of any atom when lists are made, of those that pairs act on at any time.
  // In another box than before lists are made anew. Its shortest edge must be at least twice the cutoff.
  void update_lists(const Vectors& x, const Box& box);
  // Where the atoms were at the last update_lists.
  void add_forces(Vectors& f, Onto onto = Onto::kWhatIs);
  void add_forces(const Vectors& x, const Box& box, Vectors& f) {
    update_lists(x, box);
    add_forces(f);
  }
  // There, too [kJ/mol].
  double energy();
  Eigen::Matrix3d virial();  // Σ r⊗f

  void serialize(Archive& archive);  // where the lists were made; loaded, they are made again there

  long searches() const;  // for the outer list, so far
  long prunings() const;  // to the inner one

  class Engine;  // in one of the precisions

 private:
  ClusterPairs(const PairProblem& problem, Precision precision);

  std::unique_ptr<Engine> engine_;
  bool on_every_atom_ = false;
};

}  // namespace taut
