// fix taut as a plugin: `plugin load tautplugin.so`.

#include "lammps/fix_taut.hpp"
#if __has_include(<lammps/version.h>)
#include <lammps/version.h>
#endif

#include <cstdio>
#include <cstring>

namespace {

using namespace LAMMPS_NS;

// What LAMMPS asks of a plugin, as its manual has it (Developer_plugins): a C interface, so that no header of
// its PLUGIN package is needed, which installed LAMMPS has not.
struct Plugin {
  const char *version, *style, *name, *info, *author;
  Fix* (*create)(LAMMPS*, int, char**);
  void* handle;
};
using Register = void (*)(Plugin*, LAMMPS*);

Fix* make_fix(LAMMPS* lmp, int narg, char** arg) {
  return new FixTaut(lmp, narg, arg);
}

// The name of the MPI whose headers this plugin was compiled with, as that MPI calls itself.
#if defined(OMPI_MAJOR_VERSION)
constexpr const char* kMpi = "Open MPI";
#elif defined(MPICH_VERSION)
constexpr const char* kMpi = "MPICH";
#else
constexpr const char* kMpi = "";
#endif

// Handles of one MPI mean nothing to another. Says so, and returns false, if LAMMPS runs with another one.
bool mpi_is_the_same() {
  char running[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(running, &length);
  if (std::strstr(running, kMpi)) return true;
  std::fprintf(
      stderr,
      "ERROR: Plugin fix taut was built with %s, but LAMMPS runs with %.*s; build it with LAMMPS's own MPI "
      "(cmake -DMPI_CXX_COMPILER=.../mpicxx)\n",
      kMpi, static_cast<int>(std::strcspn(running, "\n")), running);
  return false;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(LAMMPS* lmp, void* handle,
                                                                         Register add) {
  if (!mpi_is_the_same()) return;
#ifdef LAMMPS_VERSION
  const char* const version = LAMMPS_VERSION;
#else
  const char* const version = lmp->version;
#endif
  Plugin plugin{version, "fix", "taut", "rigid bonds by Baumgarte and feedforward", "taut", make_fix, handle};
  add(&plugin, lmp);
}
