#pragma once

// The kinds of vector unit that the clusters' kernels are compiled for: none, AVX2, AVX-512 (or NEON). To be
// included before anything of Highway's.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_RVV)
#endif
