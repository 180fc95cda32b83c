#pragma once

#include <vector>

#include "constraints/lanes/bond_clusters.hpp"

namespace taut {

// How the matrix of a shape, one unknown a bond, is eliminated: A = L D Lᵀ (or L D U), column after column,
//     for k, for each row p below: l_p = c_p/d_k; d_p −= l_p c_p; for rows q > p: c_qp −= l_p c_q.
// Order: by rounds, in each all unknowns of least degree that do not touch. A chain goes from both ends at
// once, a tree from its leaves (no fill), a ring by every second bond; what is in one round does not wait
// for each other, so that divisions overlap. The separators of a piece of a chain come after that and stay:
// their rows end as Schur complement and reduced right-hand side; last, bonds that are none of the piece's.
struct Elimination {
  explicit Elimination(const ClusterShape& shape);
  Elimination() = default;

  // Nothing eliminated, the bonds as they are: for methods that take them one by one.
  static Elimination none(const ClusterShape& shape);

  int size() const { return static_cast<int>(order.size()); }
  int entries() const { return static_cast<int>(row.size()); }

  int eliminated = 0, solved = 0;       // how many go, how many have an unknown: those and the separators
  std::vector<int> order;               // the k-th unknown to go is bond order[k] of the shape
  std::vector<int> column_start;        // n + 1
  std::vector<int> row;                 // of each entry of L below the diagonal, by columns
  std::vector<double> signed_inv_mass;  // A = ±(r_k·r_row)/m at the entry [1/u]; 0: fill
  std::vector<int> update;              // the entries (q, p) in the order of the loops above
};

}  // namespace taut
