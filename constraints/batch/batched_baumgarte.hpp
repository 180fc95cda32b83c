#pragma once

#include <vector>

#include "constraints/batch/batched.hpp"
#include "constraints/batch/past_lambda.hpp"
#include "constraints/methods/baumgarte.hpp"

namespace taut {

// τ = now·σ − before·σ₋, or, as σ − σ₋ = h (r − ½hv)·v, half of of_sigma·2σ + of_rate·(r − ½hv)·v.
struct LaneLaw {
  double now, before;
  double of_sigma, of_rate;

  LaneLaw(double its_now, double its_before, double h)
      : now(its_now), before(its_before), of_sigma(now - before), of_rate(2 * h * before) {}
};

// A batch with the gains and the law of each of its bonds.
struct BaumgarteBatch : RememberingBatch {
  std::vector<Gains> gains;
  std::vector<LaneLaw> laws;  // of the last push

  using RememberingBatch::RememberingBatch;
};

template <>
class Batched<Baumgarte> final : public ExtrapolatingMethod<Baumgarte, SolvedBatches<BaumgarteBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s) override;

  double promised_error() const override { return promised_; }
  std::string setting() const override { return setting_; }

 private:
  SolveStats solve(const Push& push, bool shift, State& s);

  void set_laws(const Push& push);

  double promised_, h_of_laws_ = -1;
  bool laws_start_ = false;
  std::string setting_;
};

}  // namespace taut
