#pragma once

#include "constraints/feedforward.hpp"
#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/solving.hpp"

namespace taut {

// A batch and what Feedforward keeps of it: λ of the last three steps.
struct FeedforwardBatch : SolvedBatch {
  LaneRows before, before_that;

  explicit FeedforwardBatch(const ClusterBatch& batch)
      : SolvedBatch(batch), before(rows_of_bonds(lanes)), before_that(before) {}

  std::array<LaneRows*, 3> past() { return {&lambda, &before, &before_that}; }
  void serialize(Archive& archive) { archive(lambda, before, before_that); }
};

template <>
class Batched<Feedforward> final : public ExtrapolatingMethod<Feedforward, SolvedBatches<FeedforwardBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s) override;
  SolveStats start(const System& sys, State& s) override;
  SolveStats again(const System& sys, double h, State& s) override;

 private:
  SolveStats solve(double kick, bool shift, State& s);

  double h_;
};

}  // namespace taut
