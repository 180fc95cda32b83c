// Compiles the file named HWY_TARGET_INCLUDE once for each kind of vector unit worth having: none, AVX2,
// AVX-512 (or NEON). The one to run is chosen at run time. No include guard: Highway passes through here
// once a target.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>  // keep this before highway.h
#include <hwy/highway.h>
