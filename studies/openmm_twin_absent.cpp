// Compiled where OpenMM is not there.

#include "base/errors.hpp"
#include "studies/openmm_twin.hpp"

namespace taut {
namespace {

// TAUT_MISSING: the packages to install, as found out by CMake.
[[noreturn]] void absent() {
  throw InputError("taut was built without OpenMM: " TAUT_MISSING);
}

}  // namespace

bool built_with_openmm() {
  return false;
}

struct OpenMMTwin::Impl {};

OpenMMTwin::OpenMMTwin(const std::filesystem::path&, const std::filesystem::path&, const TwinSettings&) {
  absent();
}
OpenMMTwin::OpenMMTwin(const OpenMMInput&, const TwinSettings&) {
  absent();
}
OpenMMTwin::~OpenMMTwin() = default;
void OpenMMTwin::set(const State&) {
  absent();
}
void OpenMMTwin::step(int) {
  absent();
}
State OpenMMTwin::state() const {
  absent();
}
State OpenMMTwin::state(double&) const {
  absent();
}
Vectors OpenMMTwin::kept_velocities() const {
  absent();
}
double OpenMMTwin::potential() const {
  absent();
}
double OpenMMTwin::forces_at(const Vectors&, Vectors&) {
  absent();
}

std::string openmm_version() {
  absent();
}

}  // namespace taut
