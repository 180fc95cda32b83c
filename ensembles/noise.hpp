#pragma once

#include <cstdint>

#include "base/aligned.hpp"

namespace taut {

// Fills `noise` with independent normal numbers of mean 0 and variance 1, on the threads there are. They
// depend on seed and step alone: they are the same bits on every machine and at every number of threads. Its
// size is a multiple of kNoiseBlock.
//
// Four numbers are two pairs of Box and Muller's (1958, doi:10.1214/aoms/1177706645) of the four words that
// Philox makes of the counter (n/4, stream, step): with u in (0, 1) and an angle t, √(−2 ln u) times cos t
// and sin t. The angle is taken in the first quadrant, and signs are bits of its word.
inline constexpr int kNoiseBlock = 32;
void fill_with_noise(std::uint64_t seed, std::uint64_t step, Aligned<double>& noise);

}  // namespace taut
