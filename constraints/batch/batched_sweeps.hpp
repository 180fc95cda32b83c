#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/methods/rattle.hpp"
#include "constraints/methods/shake.hpp"

namespace taut {

// A batch with its bonds in the system's order, and its multipliers. Lanes within tolerance wait for the
// other lanes of their group.
struct SweepBatch {
  LaneBatch lanes;
  LaneRows lambda;

  explicit SweepBatch(const ClusterBatch& batch)
      : lanes(batch, Elimination::none(batch.shape.bond_count())), lambda(rows_of_bonds(lanes)) {}

  void serialize(Archive& archive) { archive(lambda); }
};

template <>
class Batched<Shake> final : public BatchedMethod<Shake, LaneBatches<SweepBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
};

template <>
class Batched<Rattle> final : public BatchedMethod<Rattle, LaneBatches<SweepBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;
};

}  // namespace taut
