// Compiled where OpenMM is not there.

#include "md/errors.hpp"
#include "systems/openmm/openmm_export.hpp"

namespace taut {

// TAUT_MISSING: the packages to install, as found out by CMake.
void write_openmm(const OpenMMInput&, const std::string&) {
  throw InputError("taut was built without OpenMM: " TAUT_MISSING);
}

}  // namespace taut
