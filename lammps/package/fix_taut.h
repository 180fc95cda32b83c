// How LAMMPS finds fix taut when the package TAUT is part of it: it reads this file twice.
// clang-format off
#ifdef FIX_CLASS
FixStyle(taut,FixTaut)
#else
// clang-format on
#include "lammps/fix_taut.hpp"
#endif
