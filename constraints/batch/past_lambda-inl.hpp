// λ of the last three steps for one part. Compiled once for each SIMD target.
#if defined(TAUT_PAST_LAMBDA_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_PAST_LAMBDA_INL_H
#undef TAUT_PAST_LAMBDA_INL_H
#else
#define TAUT_PAST_LAMBDA_INL_H
#endif

#include "constraints/batch/past_lambda.hpp"
#include "constraints/batch/solving-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

struct PastLambda {
  double *lambda, *before, *before_that;

  HWY_INLINE PastLambda(RememberingBatch& batch, const Part& part)
      : lambda(batch.lambda.of(part.group) + part.first_lane),
        before(batch.before.of(part.group) + part.first_lane),
        before_that(batch.before_that.of(part.group) + part.first_lane) {}

  // Sets λ of bond k to guess(λ₁, λ₂, λ₃), moves the previous ones back by one step, and returns the guess.
  template <class GuessOf>
  HWY_INLINE V shift(int k, GuessOf guess) const {
    const V one = load(lambda + k * kLanes), two = load(before + k * kLanes);
    const V guessed = guess(one, two, load(before_that + k * kLanes));
    store(two, before_that + k * kLanes);
    store(one, before + k * kLanes);
    store(guessed, lambda + k * kLanes);
    return guessed;
  }
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
