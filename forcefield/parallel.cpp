#include "forcefield/parallel.hpp"

#include <cstdlib>

namespace taut {

int available_threads() {
#ifdef _OPENMP
  if (std::getenv("OMP_NUM_THREADS")) return omp_get_max_threads();
#endif
  return 1;
}

}  // namespace taut
