#pragma once

#include <map>
#include <optional>
#include <vector>

#include "constraints/batch/bond_clusters.hpp"

namespace taut {

// Sorts clusters into batches by shape.
class ClusterBatches {
 public:
  // Appends a cluster to the batch of its shape, and returns the batch's index.
  int add(const ClusterShape& shape, const std::vector<int>& atoms, const std::vector<int>& bonds);

  std::vector<ClusterBatch> batches;

 private:
  std::map<std::vector<double>, std::size_t> batch_of_;
  std::size_t last_ = 0;  // the batch of the previous cluster
};

// Returns whether a cluster is a chain that is long enough to have two ends.
bool is_chain(const ClusterShape& shape);

// Cuts long chains, so that a single chain fills all lanes and several threads. The cuts are at *separators*,
// bonds that leave between them a multiple of 8 equal pieces and a short piece at either end, which takes the
// remainder and the chain's special end masses. Pieces share no atom and are solved side by side;
// separators.hpp solves for the separators. A piece comes with the next two atoms and bonds of each
// neighbour; the inner one of these bonds is the separator:
//
//     o──o══●──●── … ──●──●══o──o       ● atoms of the piece  ══ separators
//
// Forces, velocities and displacements of the piece's atoms, and the right-hand sides of its separators, need
// the multipliers of these bonds only: multipliers are all that pieces exchange.
//
// piece_bonds: how many bonds a piece has, about. Without, pieces have one width that suits chains of many
// lengths, each of them too few to fill the lanes: pieces of different chains are then solved side by side.
//
// Returns false if the clusters are no chains, or if their masses and lengths do not repeat from piece to
// piece.
bool cut_chains(const ClusterBatch& batch, std::optional<int> piece_bonds, ClusterBatches& pieces,
                std::vector<std::vector<PieceOfChain>>& chains);

}  // namespace taut
