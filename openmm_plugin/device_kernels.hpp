#pragma once

namespace taut {

// The step in the language that OpenMM's common compute layer makes OpenCL, CUDA or HIP of: drift() for all atoms, and
// hold() for the clusters of one shape, a thread each.
extern const char* const kDriftSource;
extern const char* const kHoldSource;

}  // namespace taut
