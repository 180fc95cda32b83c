#pragma once

// LAMMPS's own headers. Those of January 2022 (Debian 12) call fmt::make_args_checked, which fmt 9 declares
// no longer where they look for it; nothing here calls it.
#include <fmt/format.h>
#if FMT_VERSION >= 90000
namespace fmt {
template <typename... Args, typename S>
auto make_args_checked(const S&, const std::remove_reference_t<Args>&... args)
    -> format_arg_store<format_context, std::remove_cv_t<std::remove_reference_t<Args>>...>;
}
#endif

#include <lammps/angle.h>
#include <lammps/atom.h>
#include <lammps/bond.h>
#include <lammps/comm.h>
#include <lammps/domain.h>
#include <lammps/error.h>
#include <lammps/fix.h>
#include <lammps/force.h>
#include <lammps/group.h>
#include <lammps/input.h>
#include <lammps/lammps.h>
#include <lammps/memory.h>
#include <lammps/modify.h>
#include <lammps/neighbor.h>
#include <lammps/update.h>
#include <lammps/utils.h>

namespace taut {

// What has another name in LAMMPS since 2022 than in that of January 2022.
template <class Domain>
void minimum_image(const Domain& box, double* d) {
  if constexpr (requires { box.minimum_image(FLERR, d); })
    box.minimum_image(FLERR, d);
  else
    const_cast<Domain&>(box).minimum_image(d);
}

template <class Comm>
void forward_comm(Comm& comm, LAMMPS_NS::Fix* fix) {
  if constexpr (requires { comm.forward_comm(fix); })
    comm.forward_comm(fix);
  else
    comm.forward_comm_fix(fix);
}

template <class Comm>
void reverse_comm(Comm& comm, LAMMPS_NS::Fix* fix) {
  if constexpr (requires { comm.reverse_comm(fix); })
    comm.reverse_comm(fix);
  else
    comm.reverse_comm_fix(fix);
}

}  // namespace taut
