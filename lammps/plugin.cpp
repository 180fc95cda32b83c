// fix taut as a plugin: `plugin load tautplugin.so`.

#include "lammps/fix_taut.hpp"
#if __has_include(<lammps/version.h>)
#include <lammps/version.h>
#endif

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

}  // namespace

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(LAMMPS* lmp, void* handle,
                                                                         Register add) {
#ifdef LAMMPS_VERSION
  const char* const version = LAMMPS_VERSION;
#else
  const char* const version = lmp->version;
#endif
  Plugin plugin{version, "fix", "taut", "rigid bonds by Baumgarte and feedforward", "taut", make_fix, handle};
  add(&plugin, lmp);
}
