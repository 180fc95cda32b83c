#pragma once

namespace taut {

// The step in the language that OpenMM's common compute layer makes OpenCL, CUDA or HIP of: drift() for all atoms, and
// hold() for the clusters of one shape, after the law of the method: a thread each, or a group of threads each.
extern const char* const kDriftSource;
extern const char* const kLawSource;
extern const char* const kHoldSource;
extern const char* const kGroupSource;

}  // namespace taut
