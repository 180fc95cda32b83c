// What must not stand beside this fix, or change under it: other fixes, bonds, lengths.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/errors.hpp"
#include "lammps/fix_taut.hpp"
#include "lammps/rendezvous.hpp"

namespace LAMMPS_NS {

using namespace FixConst;

namespace {
struct OpenInput : Input {  // LAMMPS tells fixes of `rerun` by the command's name alone, which is protected
  static const char* command_of(const Input& known) { return known.*(&OpenInput::command); }
};
}  // namespace

// `rerun` evaluates frames as they are.
bool FixTaut::is_rerun() const {
  const char* const command = OpenInput::command_of(*input);
  return command && std::strcmp(command, "rerun") == 0;
}

bool FixTaut::holds_bonds(const Fix& fix) const {
  constexpr const char* kStyles[] = {"^shake", "^rattle", "^ilves", "^taut"};
  return &fix != this &&
         std::ranges::any_of(kStyles, [&](const char* known) { return utils::strmatch(fix.style, known); });
}

void FixTaut::init() {
  if (utils::strmatch(update->integrate_style, "^respa"))
    refuse("run_style respa is not carried out; take verlet");
  if (domain->deform_vremap) refuse("fix deform remap v is not carried out; take remap x");
  if (lmp->kokkos)
    refuse("the KOKKOS package is on, with which this fix is not tested; start LAMMPS without -k on");
  check_order();
  refuse_atoms_held_twice();
  box_motion_.init();
  warned_of_residual_ = false;
  try {
    if (!lengths_.changed().empty())
      held_.steps_known = 0;  // between runs: setup brings bonds to new lengths
    lengths_ = taut::Lengths(*force);
    for (int i = 0; i < atom->nlocal; ++i)
      for (const taut::HeldBond& bond : held_.of(i)) lengths_(bond.kind);
  } catch (const taut::InputError& wrong) {
    stop(wrong.what());
  }
}

// Forces that are added afterwards would be missed; other fixes that hold bonds act on other atoms.
// A barostat's setup reads the pressure, which the constraint forces are part of.
void FixTaut::check_order() const {
  bool after = false;
  for (int k = 0; k < modify->nfix; ++k) {
    const Fix& other = *modify->fix[k];
    if (&other == this) {
      after = true;
      continue;
    }
    if (!after) {
      if (other.box_change && other.time_integrate && !keys_.clear && comm->me == 0 && update->whichflag == 1)
        error->warning(
            FLERR, fmt::format("Fix taut {}: the pressure with which fix {} ({}) begins lacks the constraint "
                               "forces; define fix taut before it",
                               id, other.id, other.style));
      continue;
    }
    if ((modify->fmask[k] & POST_FORCE) && !holds_bonds(other) &&
        std::strcmp(other.style, "store/force") != 0)
      refuse(
          fmt::format("fix {} ({}) adds forces afterwards; define fix taut after it", other.id, other.style));
    if (keys_.clear && (modify->fmask[k] & FINAL_INTEGRATE) && other.time_integrate)
      refuse(fmt::format("clear: fix {} ({}) moves velocities afterwards; define fix taut after it", other.id,
                         other.style));
  }
}

// A rigid body's atoms follow the body, whatever forces bonds put on them. Bodies are known at setup.
void FixTaut::refuse_rigid_bodies() const {
  for (int k = 0; k < modify->nfix; ++k) {
    Fix& other = *modify->fix[k];
    if (!other.rigid_flag) continue;
    int dimension = 0;
    const auto* const body = static_cast<const int*>(other.extract("body", dimension));
    for (int i = 0; i < atom->nlocal; ++i)
      if (held_.count(i) > 0 &&
          (body && dimension == 1 ? body[i] >= 0 : (atom->mask[i] & other.groupbit) != 0))
        stop(fmt::format(
            "atom {} has a held bond and is part of a rigid body of fix {} ({}); leave its bonds out",
            atom->tag[i], other.id, other.style));
  }
}

// A bond that another fix holds has a negative type. Both its atoms are told, and must not be held here.
void FixTaut::refuse_atoms_held_twice() const {
  bool others = false;
  for (int k = 0; k < modify->nfix; ++k) others = others || holds_bonds(*modify->fix[k]);
  if (!others) return;
  struct Told {
    tagint to;
  };
  std::vector<Told> told;
  for (int i = 0; i < atom->nlocal; ++i)
    for (int m = 0; m < atom->num_bond[i]; ++m) {
      const tagint partner = atom->bond_atom[i][m];
      const auto is_this = [&](const taut::HeldBond& bond) { return bond.partner == partner; };
      if (atom->bond_type[i][m] >= 0 || std::ranges::any_of(held_.of(i), is_this)) continue;
      told.push_back({atom->tag[i]});
      told.push_back({partner});
    }
  for (const Told& message : taut::send_to_atoms(lmp, told)) {
    const int i = atom->map(message.to);
    if (i >= 0 && held_.count(i) > 0)
      stop(fmt::format("atom {} has a bond that another fix holds; hold all bonds of a molecule by one fix",
                       message.to));
  }
}

// bond/swap, bond/react, bond/create, `set bond`, `delete_bonds undo` and fixes that add molecules change the
// list of bonds. What is held must be as it was, and nothing new may be of a held type.
void FixTaut::refuse_changed_bonds() const {
  bool swapped = false;
  for (int k = 0; k < modify->nfix; ++k)
    swapped = swapped || utils::strmatch(modify->fix[k]->style, "^bond/");
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int m = 0; m < atom->num_bond[i]; ++m) {
      const tagint partner = atom->bond_atom[i][m];
      const int type = atom->bond_type[i][m];
      const auto is_this = [&](const taut::HeldBond& bond) {
        return bond.partner == partner && bond.kind.is_bond();
      };
      const auto held = std::ranges::find_if(held_.of(i), is_this);
      if (held != held_.of(i).end()) {
        const bool spring = type != held->kind.bond && keys_.held.bonds.count(std::abs(type)) == 0;
        if (type == -held->kind.bond || spring) continue;
      } else if (keys_.held.bonds.count(std::abs(type)) == 0) {
        continue;
      } else if (type > 0) {
        const int j = atom->map(partner);
        if (j < 0 || !(atom->mask[j] & groupbit) || (is_fixed(i) && is_fixed(j))) continue;
      } else if (!swapped || held_.count(i) == 0) {
        continue;
      }
      stop(fmt::format(
          "the bond of atoms {} and {} has been made or changed since this fix was defined (set bond, "
          "delete_bonds, fix bond/..., molecules added); define fix taut again after such changes",
          atom->tag[i], partner));
    }
  }
}

// Held bonds that the list of bonds does not have any more. Both their atoms know of them, unless one was deleted; with
// newton on a bond is listed once.
void FixTaut::refuse_lost_bonds() const {
  double held = 0, listed = 0;
  for (int i = 0; i < atom->nlocal; ++i)
    for (const taut::HeldBond& bond : held_.of(i)) {
      if (!bond.kind.is_bond()) continue;
      const bool whole = atom->map(bond.partner) >= 0;
      held += whole ? 0.5 : 1;
      if (!whole) continue;
      for (int m = 0; m < atom->num_bond[i]; ++m)
        if (atom->bond_atom[i][m] == bond.partner && std::abs(atom->bond_type[i][m]) == bond.kind.bond)
          listed += force->newton_bond ? 1 : 0.5;
    }
  const double lost = all_sum(held) - all_sum(listed);
  if (std::abs(lost) > 0.25)
    refuse(fmt::format(
        "{:g} held bond{} not in the list of bonds any more; define fix taut again after bonds are "
        "deleted",
        lost, lost == 1 ? " is" : "s are"));
}

void FixTaut::refuse_changed_lengths() {
  const std::string changed = lengths_.changed();
  if (!changed.empty())
    refuse(changed + "; during a run lengths cannot change (fix adapt bond, bond_coeff): end the run first");
}

void FixTaut::post_run() {
  leave_lists(acted_);
  if (update->whichflag == 1) refuse_changed_lengths();
  refuse_lost_bonds();
}

void FixTaut::warn_of_residual(double residual) {
  constexpr double kFar = 100;
  const double promised = solve_->promised_error();
  if (!std::isfinite(promised) || warned_of_residual_) return;  // nothing is promised
  const double bound = std::max({promised, kFar * keys_.tolerance(), 1e-10});
  if (!(residual > bound)) return;
  warned_of_residual_ = true;
  if (comm->me == 0)
    error->warning(
        FLERR,
        fmt::format("Fix taut {}, step {}: held bonds are off by {:.2g} of their length; every held atom "
                    "must be moved by velocity Verlet (nve, nvt, npt), or be in the group of `fixed`",
                    id, update->ntimestep, residual));
}

}  // namespace LAMMPS_NS
