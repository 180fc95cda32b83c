#pragma once

namespace taut {

// Options that several methods have. Each throws InputError with the key as the user wrote it.
void check_tolerance(double tolerance);                    // outside [1e-15, 0.1]
void check_count(const char* key, int count, int fewest);  // "method.max_sweeps", less than so many

}  // namespace taut
