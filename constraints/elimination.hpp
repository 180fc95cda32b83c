#pragma once

#include <cstddef>
#include <vector>

#include "constraints/bond_graph.hpp"

namespace taut {

// How a matrix of coupled bonds, one unknown a bond, is factored as A = L D U without pivoting (U = Lᵀ where
// A is symmetric), column after column, in place of its entries c below and c' above the diagonal:
//     for k, for each row p below: l_p = c_p/d_k; u_p = c'_p/d_k; d_p −= l_p c'_p;
//         for each row q below p: c_qp −= u_p c_q; c'_pq −= l_p c'_q.
// By rounds: in each all unknowns of least degree that do not touch; so chains go from both ends at
// once, trees from their leaves (no fill), rings by every second bond, and what is in one round does not wait
// for each other. What coupled bonds have to do with each other stays together.
struct Elimination {
  enum Stage : char {
    kEliminated,  // goes in its round
    kKept,        // stays to the end: its rows end as Schur complement and reduced right-hand side
    kApart        // no unknown: last, coupled to none
  };

  enum class Order { kRounds, kMinimumDegree };  // the latter approximate, for systems of any size

  explicit Elimination(const Couplings& couplings, std::vector<Stage> stage = {}, Order by = Order::kRounds);

  // Nothing eliminated, the bonds as they are: for methods that take them one by one.
  static Elimination none(int bonds) { return Elimination(Couplings(bonds)); }

  int size() const { return static_cast<int>(order.size()); }
  int entries() const { return static_cast<int>(row.size()); }
  int clusters() const;  // sets of coupled bonds

  int eliminated, solved;               // how many go, how many have an unknown: those and the kept
  std::vector<int> order;               // the k-th unknown to go is bond order[k]
  std::vector<int> column_start;        // n + 1
  std::vector<std::ptrdiff_t> row;      // of each entry of L below the diagonal, by columns
  std::vector<double> signed_inv_mass;  // A = ±(r_k·r_row)/m at the entry [1/u]; 0: fill
  std::vector<std::ptrdiff_t> update;   // the entries (q, p) in the order of the loops above

 private:
  std::vector<std::vector<int>> find_order(const Couplings& couplings, const std::vector<Stage>& stage,
                                           Order by);
};

}  // namespace taut
