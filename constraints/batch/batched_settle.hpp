#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/batch/solving.hpp"
#include "constraints/methods/settle.hpp"

namespace taut {

// Waters of one shape, with atoms apex, left, right and bonds apex–left, apex–right, left–right.
struct SettleBatch : SolvedBatch {
  double ra, rb, rc;  // [nm], as in settle.hpp

  SettleBatch(const ClusterBatch& batch, const Settle::Water& water)
      : SolvedBatch(batch), ra(water.ra), rb(water.rb), rc(water.rc) {}

  void serialize(Archive& archive) { archive(lambda); }
};

template <>
class Batched<Settle> final : public BatchedMethod<Settle, LaneBatches<SettleBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  std::string setting() const override;
};

}  // namespace taut
