#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/batch/solving.hpp"
#include "constraints/methods/newton.hpp"

namespace taut {

// A batch with the data that Newton keeps for it.
struct NewtonBatch : SolvedBatch {
  LaneRows factors;  // 1/d and L at the last positions; pieces have them in scratch

  explicit NewtonBatch(const ClusterBatch& batch)
      : SolvedBatch(batch),
        factors(lanes.groups, lanes.piece() ? 0 : lanes.bond_count() + lanes.plan.entries()) {}

  void serialize(Archive& archive) { archive(lambda, factors, scratch); }
};

template <>
class Batched<Newton> final : public BatchedMethod<Newton, SolvedBatches<NewtonBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override;

 private:
  bool factored_ = false;
};

}  // namespace taut
