#include "constraints/batch/separators.hpp"

namespace taut {
namespace {

// The rows of a piece's separators and of its neighbours' bonds (elimination puts inner bonds first).
struct EndRows {
  explicit EndRows(const LaneBatch& batch)
      : left(batch.plan.eliminated),
        right(batch.plan.solved - 1),
        beyond_left(batch.plan.solved),
        beyond_right(batch.bond_count() - 1) {}
  int left, right;                // separators
  int beyond_left, beyond_right;  // the neighbours' bonds
};

// Returns the row of the inner bond next to one end.
int inner_row(const LaneBatch& batch, bool at_left) {
  const int atom = 3 * kLanes * (at_left ? batch.left : batch.atoms - 1 - batch.right);
  int row = 0;
  while ((at_left ? batch.bonds[row].i : batch.bonds[row].j) != atom) ++row;
  return row;
}

}  // namespace

void Separators::repeat_last_lane(const LaneBatch& batch, int number, int first_row, int end_row,
                                  Copies& copies) {
  const int group = batch.groups - 1, filled = batch.filled(group);
  for (int row = first_row; row < end_row; ++row)
    for (int lane = filled; lane < kLanes; ++lane)
      copies.push_back({{number, group, row * kLanes + lane}, {number, group, row * kLanes + filled - 1}});
}

Separators::Separators(const std::vector<std::vector<PieceOfChain>>& chains,
                       const std::vector<const LaneBatch*>& batches) {
  for (const LaneBatch* batch : batches) layout_.emplace_back(*batch);
  const auto place = [](const PieceOfChain& piece, int row) {
    return LaneEntry{piece.batch, piece.cluster / kLanes, row * kLanes + piece.cluster % kLanes};
  };
  for (const auto& chain : chains)
    for (std::size_t p = 0; p + 1 < chain.size(); ++p) {
      const PieceOfChain &before = chain[p], &after = chain[p + 1];
      const LaneBatch &batch = *batches[before.batch], &next = *batches[after.batch];
      const EndRows ends(batch), next_ends(next);
      const LaneBond& bond = batch.bonds[ends.right];
      separators_.push_back(
          {.before = place(before, ends.right),
           .after = place(after, next_ends.left),
           .coupling = place(before, batch.plan.entries() - 1),
           .first = p == 0,
           .least_pivot = bond.least_pivot,
           .bond = batch.bond(before.cluster / kLanes, ends.right, before.cluster % kLanes)});
      shared_.push_back({place(before, ends.beyond_right), place(after, inner_row(next, true))});
      shared_.push_back({place(after, next_ends.beyond_left), place(before, inner_row(batch, false))});
    }
  for (std::size_t b = 0; b < batches.size(); ++b) {
    const LaneBatch& batch = *batches[b];
    repeat_last_lane(batch, static_cast<int>(b), batch.plan.eliminated, batch.plan.solved, repeated_);
    repeat_last_lane(batch, static_cast<int>(b), batch.plan.solved, batch.bond_count(), shared_);
  }
  inv_d_.resize(separators_.size());
  above_.resize(separators_.size());
  b_.resize(separators_.size());
}

}  // namespace taut
