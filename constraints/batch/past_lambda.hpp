#pragma once

#include <array>

#include "constraints/batch/solving.hpp"

namespace taut {

// A batch that keeps λ of the last three steps.
struct RememberingBatch : SolvedBatch {
  LaneRows before, before_that;

  explicit RememberingBatch(const ClusterBatch& batch)
      : SolvedBatch(batch), before(rows_of_bonds(lanes)), before_that(before) {}

  std::array<LaneRows*, 3> past() { return {&lambda, &before, &before_that}; }
  void serialize(Archive& archive) { archive(lambda, before, before_that); }
};

}  // namespace taut
