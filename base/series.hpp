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

// Returns the sample at which the equilibrated part of a series begins: the first t₀ for which the number of
// independent samples that remain, (N − t₀)/g(t₀), is largest (Chodera 2016, doi:10.1021/acs.jctc.5b00784).
// It tries 100 evenly spaced values of t₀, none of them in the last tenth, on means of neighbours where there are
// more than 2000 samples.
std::size_t equilibration_end(std::span<const double> series);

// The mean of independent values; its error from their spread, 0 for a single one.
Estimate independent_mean(std::span<const double> values);

}  // namespace taut
