// Run by CMake: the version of the OpenMM that the plug-in is built for.

#include <openmm/Platform.h>

#include <cstdio>

int main() {
  std::puts(OpenMM::Platform::getOpenMMVersion().c_str());
}
