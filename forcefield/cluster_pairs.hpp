#pragma once

#include <memory>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// The pair forces of a scene, in vectors over clusters of atoms sorted in space, by threads. The same sums
// as LennardJonesCoulomb (without its exceptions' own forces) and WcaBeads, which say them plainly.
//
// A list holds the clusters within cutoff + buffer of each other, and serves until two atoms together may
// have come nearer by the buffer. The order of all sums is fixed by the list and the number of threads.
class ClusterPairs {
 public:
  ClusterPairs(const Nonbonded& nb, const Box& box, Precision precision);
  ClusterPairs(const Wca& wca, int atoms, const Box& box, Precision precision);
  ~ClusterPairs();
  ClusterPairs(ClusterPairs&&) noexcept;
  ClusterPairs& operator=(ClusterPairs&&) noexcept;

  // Throws SimulationFailure for a position that is not finite.
  void add_forces(const Vectors& x, Vectors& f);
  double energy();  // at the positions of the last add_forces [kJ/mol]

  long builds() const;  // of the list, so far

  class Engine;  // in one of the precisions

 private:
  std::unique_ptr<Engine> engine_;
};

}  // namespace taut
