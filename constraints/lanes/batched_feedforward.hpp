#pragma once

#include "constraints/feedforward.hpp"
#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/past_lambda.hpp"

namespace taut {

template <>
class Batched<Feedforward> final : public ExtrapolatingMethod<Feedforward, SolvedBatches<RememberingBatch>> {
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
