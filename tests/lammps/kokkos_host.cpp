// Makes fixes believe, when they are initialised, that LAMMPS runs with its KOKKOS package: preloaded into a LAMMPS that
// has not got it. mpicxx -std=c++20 -shared -fPIC -I ../.. -I /usr/include/lammps kokkos_host.cpp -o kokkos_host.so
#include <dlfcn.h>

#include "lammps/lammps_headers.hpp"

void LAMMPS_NS::Modify::init() {
  lmp->kokkos = reinterpret_cast<KokkosLMP*>(lmp);
  reinterpret_cast<void (*)(Modify*)>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS6Modify4initEv"))(this);
  lmp->kokkos = nullptr;
}
