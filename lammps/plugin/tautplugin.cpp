// fix taut as a plugin: `plugin load tautplugin.so`.

#include <lammpsplugin.h>
#include <version.h>

#include "lammps/fix_taut.hpp"

namespace {

LAMMPS_NS::Fix* make_fix(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) {
  return new LAMMPS_NS::FixTaut(lmp, narg, arg);
}

}  // namespace

extern "C" void lammpsplugin_init(void* lmp, void* handle, void* regfunc) {
  lammpsplugin_t plugin{};
  plugin.version = LAMMPS_VERSION;
  plugin.style = "fix";
  plugin.name = "taut";
  plugin.info = "rigid bonds by Baumgarte and feedforward";
  plugin.author = "taut";
  plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2*>(&make_fix);
  plugin.handle = handle;
  reinterpret_cast<lammpsplugin_regfunc>(regfunc)(&plugin, lmp);
}
