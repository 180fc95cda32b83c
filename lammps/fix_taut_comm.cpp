// What is known with an atom, and how it travels: held bonds to other processors, to ghosts and into restart
// files whenever atoms do; motion and multipliers to ghosts in every step.

#include <algorithm>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::grow_arrays(int room) {
  held_.grow(room);
  motion_.resize(static_cast<std::size_t>(room) * motion_size_);
  if (!keys_.store) return;
  forces_.resize(3 * static_cast<std::size_t>(room));
  force_rows_.resize(room);
  for (int i = 0; i < room; ++i) force_rows_[i] = &forces_[3 * static_cast<std::size_t>(i)];
  array_atom = force_rows_.data();
}

int FixTaut::pack_border(int n, int* list, double* buffer) {
  int m = 0;
  for (int k = 0; k < n; ++k) m += held_.pack(list[k], buffer + m);
  return m;
}

int FixTaut::unpack_border(int n, int first, double* buffer) {
  int m = 0;
  for (int i = first; i < first + n; ++i) m += held_.unpack(i, buffer + m);
  return m;
}

// Of an atom in a restart file: how many numbers, how many steps are known, the bonds.
int FixTaut::size_restart(int i) {
  store_past();
  return 2 + held_.packed(i);
}

int FixTaut::pack_restart(int i, double* buffer) {
  store_past();
  const int size = 2 + held_.pack(i, buffer + 2);
  buffer[0] = size;
  buffer[1] = held_.steps_known;
  return size;
}

void FixTaut::unpack_restart(int i, int nth) {
  const double* next = atom->extra[i];
  for (int k = 0; k < nth; ++k) next += static_cast<int>(*next);
  if (!taut::HeldBonds::fits(next + 2, static_cast<int>(next[0]) - 2))
    stop(
        "another version of fix taut wrote this restart file: give the fix another ID than there, and it "
        "starts without the multipliers of earlier steps");
  held_.steps_known = static_cast<int>(next[1]);
  held_.unpack_past(i, next + 2);
}

// --- which ghosts are told ---

// Few ghosts are parts of what a processor solves. Whenever lists are built it asks for these, by a reverse
// communication of one number a held ghost; LAMMPS hands ghosts on from processor to processor, and so are
// questions, the other way. Forward communications then are of the atoms that were asked for.
void FixTaut::ask_for_ghosts() {
  asked_for_.assign(atom->nlocal + atom->nghost, false);
  for (const taut::Image& image : solve_->local().images) asked_for_[image.atom] = true;
  for (const taut::OuterBond& bond : solve_->local().outer) asked_for_[bond.outer.atom] = true;
  told_.clear();
  heard_.clear();
  taut::reverse_comm(*comm, this);
  std::vector<char> is_told(atom->nlocal + atom->nghost, false);
  for (const auto& [list, message] : told_)
    for (const int i : message.atoms) is_told[i] = i < atom->nlocal;
  taut::LocalSystem& local = solve_->local();
  local.told.clear();
  for (int k = 0; k < local.system.bond_count(); ++k)
    if (is_told[local.images[local.system.bonds[k].i].atom]) local.told.emplace_back(k, local.places[k][0]);
  for (const int k : local.shared) local.told.emplace_back(k, local.places[k][1]);
}

void FixTaut::Message::add(int i, taut::HeldBonds& held) {
  atoms.push_back(i);
  for (int m = held.first_upward(i); m < held.count(i); ++m) upward.push_back(&held.of(i)[m]);
}

int FixTaut::pack_reverse_comm(int n, int first, double* buffer) {
  double* next = buffer;
  for (int i = first; i < first + n; ++i) {
    if (held_.count(i) == 0) continue;
    *next++ = asked_for_[i];
    if (asked_for_[i]) heard_[first].add(i, held_);
  }
  return static_cast<int>(next - buffer);
}

void FixTaut::unpack_reverse_comm(int n, int* list, double* buffer) {
  const double* next = buffer;
  for (int k = 0; k < n; ++k) {
    if (held_.count(list[k]) == 0 || *next++ == 0) continue;
    asked_for_[list[k]] = true;
    told_[list].add(list[k], held_);
  }
}

// --- forward communication ---

void FixTaut::forward_comm(Forward what) {
  forward_ = what;
  if (what != Forward::kMultipliers) set_own_motion();
  if (ghosts_) taut::forward_comm(*comm, this);
}

// h v + h² f/m as a velocity, or v and f, and how the box carries the atom.
void FixTaut::set_own_motion() {
  const double factor = kick_ / update->dt * force->ftm2v;
  const bool foretold = forward_ == Forward::kMotion && motion_size_ == 3;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (held_.count(i) == 0) continue;
    double* const to = motion_of(i);
    const double *v = atom->v[i], *f = atom->f[i], push = foretold && !is_fixed(i) ? factor / mass(i) : 0;
    for (int c = 0; c < 3; ++c) to[c] = v[c] + push * f[c];
    if (motion_size_ > 3)
      for (int c = 0; c < 3; ++c) to[3 + c] = f[c];
    if (carries_with_box()) Eigen::Map<taut::Vec3>(to) += box_motion_.carried(i);
  }
}

int FixTaut::motion_sent() const {
  if (forward_ == Forward::kMultipliers) return 0;
  return forward_ == Forward::kVelocities ? 3 : motion_size_;
}

// Motion, and where chains are cut the multipliers of the atom's bonds to higher tags. An atom across the
// periodic boundary is pbc box vectors away from its ghost.
int FixTaut::pack_forward_comm(int, int* list, double* buffer, int pbc_flag, int* pbc) {
  const auto message = told_.find(list);
  if (message == told_.end()) return 0;
  double* next = buffer;
  const int motion = motion_sent();
  taut::Vec3 beside = taut::Vec3::Zero();
  if (carries_with_box() && pbc_flag) beside = box_motion_.carried_image(taut::Vec3(pbc[0], pbc[1], pbc[2]));
  if (motion > 0)
    for (const int i : message->second.atoms) {
      const double* const from = motion_of(i);
      for (int m = 0; m < motion; m += 3, next += 3)
        for (int c = 0; c < 3; ++c) next[c] = from[m + c] + (m == 0 ? beside[c] : 0);
    }
  if (forwards_multipliers())
    for (const taut::HeldBond* bond : message->second.upward) *next++ = bond->told;
  return static_cast<int>(next - buffer);
}

void FixTaut::unpack_forward_comm(int n, int first, double* buffer) {
  const auto message = heard_.find(first);
  if (n == 0 || message == heard_.end()) return;
  const double* next = buffer;
  const int motion = motion_sent();
  if (motion > 0)
    for (const int i : message->second.atoms) {
      double* const to = motion_of(i);
      for (int m = 0; m < motion; m += 3, next += 3)
        for (int c = 0; c < 3; ++c) to[m + c] = next[c];
    }
  if (forwards_multipliers())
    for (taut::HeldBond* bond : message->second.upward) bond->told = *next++;
}

void FixTaut::read_outer(bool next_step) {
  const auto& outer = solve_->local().outer;
  for (std::size_t b = 0; b < outer.size(); ++b) {
    const double lambda = outer[b].held->told;
    auto& past = outer[b].held->past;
    if (!next_step) {
      solve_->outer_lambda[b] = lambda;
    } else {
      if (!outer_is_shifted_) std::copy_backward(past.begin(), past.end() - 1, past.end());
      past[0] = lambda;
    }
  }
}

}  // namespace LAMMPS_NS
