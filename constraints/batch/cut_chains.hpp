#pragma once

#include <map>
#include <vector>

#include "constraints/batch/bond_clusters.hpp"

namespace taut {

// Clusters on their way into batches, by shape.
class ClusterBatches {
 public:
  // Returns the batch; the cluster is its last one.
  int add(const ClusterShape& shape, const std::vector<int>& atoms, const std::vector<int>& bonds);

  std::vector<ClusterBatch> batches;

 private:
  std::map<std::vector<double>, std::size_t> batch_of_;
  std::size_t last_ = 0;  // the batch of the cluster before
};

// Cuts long chains so that one alone fills all lanes and several threads: at *separators*, bonds that leave
// between them a multiple of 8 equal pieces and a short one at either end, which takes what does not divide
// and what masses a chain has of its own there. Pieces share no atom, so that they are worked on side by
// side; what ties them is solved between (separators.hpp). A piece comes with the next two atoms and bonds of
// each neighbour, of which the inner bond is the separator:
//
//     o──o══●──●── … ──●──●══o──o       ● its own atoms  ══ separators
//
// Forces, velocities and displacements of its own atoms and the right-hand sides of its separators need no
// more than these bonds' multipliers, so that the multipliers are all that pieces tell each other.
//
// False if the batch's clusters are no chains, or their pieces not equal: masses and lengths must repeat.
bool cut_chains(const ClusterBatch& batch, int piece_bonds, ClusterBatches& pieces,
                std::vector<std::vector<PieceOfChain>>& chains);

}  // namespace taut
