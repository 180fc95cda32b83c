#pragma once

#include <cstddef>
#include <vector>

#include "constraints/bond_graph.hpp"

namespace taut {

// The order and the memory layout for factoring a matrix of coupled bonds, one unknown per bond, as A = L D U
// without pivoting (U = Lᵀ if A is symmetric). The factorization goes column by column and overwrites the
// entries c below and c' above the diagonal:
//     for k, for each row p below: l_p = c_p/d_k; u_p = c'_p/d_k; d_p −= l_p c'_p;
//         for each row q below p: c_qp −= u_p c_q; c'_pq −= l_p c'_q.
// Unknowns are eliminated in rounds. Each round takes all unknowns of smallest degree that are not coupled to
// each other, so that their eliminations are independent. Chains are eliminated from both ends at once, trees
// from their leaves (without fill), and rings by every second bond.
struct Elimination {
  enum Stage : char {
    kEliminated,  // is eliminated in its round
    kKept,        // is not eliminated: its rows become the Schur complement and the reduced right-hand side
    kApart        // has no unknown: comes last and is coupled to no other bond
  };

  enum class Order { kRounds, kMinimumDegree };  // kMinimumDegree is approximate, for systems of any size

  explicit Elimination(const Couplings& couplings, std::vector<Stage> stage = {}, Order by = Order::kRounds);

  // Returns a plan that eliminates nothing and keeps the bonds' order, for methods that visit them one by
  // one.
  static Elimination none(int bonds) { return Elimination(Couplings(bonds)); }

  int size() const { return static_cast<int>(order.size()); }
  int entries() const { return static_cast<int>(row.size()); }
  int clusters() const;  // number of sets of coupled bonds

  int eliminated, solved;               // number of eliminated unknowns; number of eliminated and kept ones
  std::vector<int> order;               // the k-th unknown is bond order[k]
  std::vector<int> column_start;        // n + 1
  std::vector<std::ptrdiff_t> row;      // of each entry of L below the diagonal, by columns
  std::vector<double> signed_inv_mass;  // s in A_entry = s r_k·r_row, of Couplings [1/u]; 0 for fill
  std::vector<std::ptrdiff_t> update;   // the entries (q, p) in the order of the loops above

 private:
  std::vector<std::vector<int>> find_order(const Couplings& couplings, const std::vector<Stage>& stage,
                                           Order by);
};

}  // namespace taut
