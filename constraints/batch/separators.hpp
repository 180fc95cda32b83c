#pragma once

#include <vector>

#include "constraints/batch/lanes.hpp"

namespace taut {

// Solves for the separators of cut chains (cut_chains.hpp). With inner bonds I and separators S,
//     A_II λ_I + A_IS λ_S = b_I,   A_SI λ_I + A_SS λ_S = b_S:
// each piece eliminates its inner bonds. The remaining system for the separators,
//     (A_SS − A_SI A_II⁻¹ A_IS) λ_S = b_S − A_SI A_II⁻¹ b_I,
// is tridiagonal along the chain. Each entry is a sum over the pieces on both sides of a separator. It is
// solved here, one chain after the other; then each piece substitutes back (the partition method of Wang
// 1981, doi:10.1145/355945.355951).
class Separators {
 public:
  Separators() = default;
  Separators(const std::vector<std::vector<PieceOfChain>>& chains,
             const std::vector<const LaneBatch*>& batches);

  // Copies the values of neighbours' bonds from the pieces that own them. rows(batch): LaneRows that begin
  // with one row per bond.
  template <class RowsOf>
  void share(const RowsOf& rows) const {
    for (const auto& [to, from] : shared_) at(rows, to, 0) = at(rows, from, 0);
  }

  // Solves for the separators. rows(batch): the scratch of the batch's parts, laid out as SystemRows.
  template <class RowsOf>
  SolveStats solve(const RowsOf& rows) {
    for (std::size_t s = 0; s < separators_.size(); ++s) {
      const Separator& here = separators_[s];
      const SystemRows &before = layout_[here.before.batch], &after = layout_[here.after.batch];
      double d = at(rows, here.before, before.d) + at(rows, here.after, after.d);
      double b = at(rows, here.before, before.b) + at(rows, here.after, after.b);
      if (!here.first) {
        const double above = at(rows, here.coupling, before.u), below = at(rows, here.coupling, before.l);
        const double l = below * inv_d_[s - 1];
        above_[s - 1] = above;
        d -= l * above;
        b -= l * b_[s - 1];
      }
      if (!(d > here.least_pivot)) return {.worst_bond = here.bond, .failure = Failure::kSingular};
      inv_d_[s] = 1 / d;
      b_[s] = b;
    }
    for (std::size_t s = separators_.size(); s-- > 0;) {
      const Separator& here = separators_[s];
      const bool last = s + 1 == separators_.size() || separators_[s + 1].first;
      b_[s] = (last ? b_[s] : b_[s] - above_[s] * b_[s + 1]) * inv_d_[s];
      at(rows, here.before, layout_[here.before.batch].b) = b_[s];
      at(rows, here.after, layout_[here.after.batch].b) = b_[s];
    }
    for (const auto& [to, from] : repeated_)
      at(rows, to, layout_[to.batch].b) = at(rows, from, layout_[to.batch].b);
    return {};
  }

 private:
  // The address of one number: a bond or an entry of the matrix in one lane.
  struct LaneEntry {
    int batch, group, cell;
  };
  struct Separator {
    LaneEntry before, after;  // in the pieces on both sides
    LaneEntry coupling;       // to the previous separator, in the piece between them
    bool first;               // whether it is the first of its chain
    double least_pivot;
    int bond;
  };

  template <class RowsOf>
  static double& at(const RowsOf& rows, const LaneEntry& entry, int row) {
    return rows(entry.batch).of(entry.group)[row * kLanes + entry.cell];
  }

  using Copies = std::vector<std::pair<LaneEntry, LaneEntry>>;  // to, from

  // Makes unused lanes of a batch's last group repeat the last piece.
  static void repeat_last_lane(const LaneBatch& batch, int number, int first_row, int end_row,
                               Copies& copies);

  Copies shared_;    // bonds of neighbours
  Copies repeated_;  // separators in unused lanes
  std::vector<Separator> separators_;
  std::vector<SystemRows> layout_;  // of each batch
  std::vector<double> inv_d_, above_, b_;
};

}  // namespace taut
