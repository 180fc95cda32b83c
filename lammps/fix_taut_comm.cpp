// What is known with an atom, and how it travels: held bonds to other processors, to ghosts and into restart
// files whenever atoms do; motion and multipliers to ghosts in every step.

#include <algorithm>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::grow_arrays(int room) {
  held_.grow(room);
  motion_.resize(static_cast<std::size_t>(room) * motion_size_);
  multipliers_.resize(static_cast<std::size_t>(room) * most_upward_);
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
  held_.steps_known = static_cast<int>(next[1]);
  held_.unpack_past(i, next + 2);
}

// --- forward communication ---

void FixTaut::forward_comm(Forward what) {
  forward_ = what;
  set_own_values();
  if (ghosts_) taut::forward_comm(*comm, this);
}

// Motion: h v + h² f/m as a velocity, or v and f; and where chains are cut, multipliers of the atom's bonds
// to higher tags.
void FixTaut::set_own_values() {
  const double factor = kick_ / update->dt * force->ftm2v;
  const bool foretold = forward_ == Forward::kMotion && motion_size_ == 3;
  for (int i = 0; i < atom->nlocal && forward_ != Forward::kMultipliers; ++i) {
    double* const to = motion_of(i);
    const double *v = atom->v[i], *f = atom->f[i], push = foretold ? factor / mass(i) : 0;
    for (int c = 0; c < 3; ++c) to[c] = v[c] + push * f[c];
    if (motion_size_ > 3)
      for (int c = 0; c < 3; ++c) to[3 + c] = f[c];
  }
  for (int i = 0; i < atom->nlocal && forwards_multipliers(); ++i) {
    const auto bonds = held_.of(i);
    const std::size_t first = held_.first_upward(i);
    for (int k = 0; k < most_upward_; ++k)
      multipliers_of(i)[k] = first + k < bonds.size() ? bonds[first + k].past[0] : 0;
  }
}

int FixTaut::motion_sent() const {
  if (forward_ == Forward::kMultipliers) return 0;
  return forward_ == Forward::kVelocities ? 3 : motion_size_;
}

int FixTaut::pack_forward_comm(int n, int* list, double* buffer, int, int*) {
  double* next = buffer;
  const int motion = motion_sent(), more = forwards_multipliers() ? most_upward_ : 0;
  for (int k = 0; k < n; ++k) {
    const int i = list[k];
    const double* const from = motion_of(i);
    for (int m = 0; m < motion; m += 3, next += 3)
      for (int c = 0; c < 3; ++c) next[c] = from[m + c];
    for (int m = 0; m < more; ++m) *next++ = multipliers_of(i)[m];
  }
  return static_cast<int>(next - buffer);
}

void FixTaut::unpack_forward_comm(int n, int first, double* buffer) {
  const double* next = buffer;
  const int motion = motion_sent(), more = forwards_multipliers() ? most_upward_ : 0;
  for (int i = first; i < first + n; ++i) {
    double* const to = motion_of(i);
    for (int m = 0; m < motion; m += 3, next += 3)
      for (int c = 0; c < 3; ++c) to[m + c] = next[c];
    for (int m = 0; m < more; ++m) multipliers_of(i)[m] = *next++;
  }
}

void FixTaut::read_outer(bool next_step) {
  const auto& outer = solve_->pieces().outer;
  for (std::size_t b = 0; b < outer.size(); ++b) {
    const double lambda = multipliers_of(outer[b].ghost)[outer[b].slot];
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
