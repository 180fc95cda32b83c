#pragma once

#include <cstddef>
#include <span>

#include "base/statistics.hpp"

namespace taut {

// Statistics of a series at even times whose samples are correlated.

// The statistical inefficiency: so many samples tell as much as one independent sample. With the normalised
// correlation C(k) of samples that are k apart,
//     g = 1 + 2 Σ_k (1 − k/N) C(k),
// summed until C first falls to zero (Chodera et al. 2007, doi:10.1021/ct0502864). At least 1.
double statistical_inefficiency(std::span<const double> y);

// The mean and its standard error √(s²/(N/g − 1)). The 1 corrects for deviations being taken from the sample's
// own mean. The error is 0 for fewer than 3 independent samples, which cannot tell their own spread.
Estimate correlated_mean(std::span<const double> y);

// True if the series follows a straight line whose slope is more than `errors` of its standard errors from 0. Those come
// from the deviations from the line, √(12/N) times the error of their mean in the line's own length.
bool has_trend(std::span<const double> y, double errors);

// The mean of a run that may not have settled at its beginning, with an error that covers what the beginning does to
// it. The error is the largest of
// - that of correlated samples, which are taken for three independent ones at least;
// - half the difference D between the means of the first and the second half: if the quantity settles within the
//   first half, the mean is off by D/2, and if nothing drifts, D/2 has the standard error of the mean;
// - D, where the series has a trend of more than four errors: an exponential decay in 0.3 of the run's length T
//   leaves its mean off by 0.7 D, one in T by 2 D. Slower ones are not covered: a run does not show how far it has
//   still to go.
Estimate mean_of_run(std::span<const double> y);

// Returns the sample at which the equilibrated part of a series begins: the first t₀ for which the number of
// independent samples that remain, (N − t₀)/g(t₀), is largest (Chodera 2016, doi:10.1021/acs.jctc.5b00784).
// It tries 100 evenly spaced values of t₀, none of them in the last tenth, on means of neighbours where there are
// more than 2000 samples.
std::size_t equilibration_end(std::span<const double> series);

// The mean of independent values; its error from their spread, 0 for a single one.
Estimate independent_mean(std::span<const double> values);

}  // namespace taut
