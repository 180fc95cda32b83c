#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/batch/past_lambda.hpp"
#include "constraints/methods/feedforward.hpp"

namespace taut {

template <>
class Batched<Feedforward> final : public ExtrapolatingMethod<Feedforward, SolvedBatches<RememberingBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s) override;

 private:
  SolveStats solve(const Push& push, bool shift, State& s);
};

}  // namespace taut
