#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/batch/past_lambda.hpp"
#include "constraints/methods/baumgarte.hpp"

namespace taut {

// The coefficients of the law for one bond at a given h, with the guess λ* already part of the forces:
//     A (λ − λ*) = −(rate_a r·a + rate_v r·w + square_v |w|² + cross w·a + square_a |a|²
//                    + sigma (|r|² − d²)),
// where a and w of the bond contain λ*. With q = 1 + αh (lagged damping: 1), rate_v = 2α/q, square_v = 1/q,
// sigma = β²/2q; rate_a = 1/q (lagged: 1 − αh, since v_half = w − ½ha); cross = αh²/q (discrete, centred);
// square_a = ¼h²/q (discrete).
struct BaumgarteCoefficients {
  double rate_a, rate_v, square_v, cross, square_a, sigma;
};

// A batch with the data that Baumgarte keeps for it.
struct BaumgarteBatch : RememberingBatch {
  std::vector<Gains> gains;                         // of each bond
  std::vector<BaumgarteCoefficients> coefficients;  // of each bond, at the last h
  Guess guess;                                      // the same for every bond of one shape

  using RememberingBatch::RememberingBatch;
};

struct BaumgarteStep {
  double h;
  int known;   // number of previous steps whose λ is known
  bool shift;  // whether λ is extrapolated, and the previous one stored
  int passes;
  const double *x, *v, *noise;  // noise: null for none
  double* f;
};

template <>
class Batched<Baumgarte> final : public ExtrapolatingMethod<Baumgarte, SolvedBatches<BaumgarteBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, const Push& push, State& s) override;
  SolveStats again(const System& sys, const Push& push, State& s) override;

  std::string setting() const override { return setting_; }

 private:
  void set_coefficients(double h);
  SolveStats solve(const Push& push, bool shift, State& s);

  Damping damping_;
  std::string setting_;
  double h_of_coefficients_ = -1;
};

}  // namespace taut
