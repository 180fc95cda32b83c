// LAMMPS's own command, with `fix taut` among its fixes. What LAMMPS is linked into is under the GNU General
// Public License, version 2: this program is.

#include <cstdio>
#include <cstring>

#include "lammps/fix_taut.hpp"

namespace {

LAMMPS_NS::Fix* make_fix(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) {
  return new LAMMPS_NS::FixTaut(lmp, narg, arg);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    LAMMPS_NS::LAMMPS lmp(argc, argv, MPI_COMM_WORLD);
    (*lmp.modify->fix_map)["taut"] = make_fix;
    lmp.input->file();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
}
