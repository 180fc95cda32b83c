// What is known with an atom, and how it travels: held bonds to other processors, to ghosts and into restart
// files whenever atoms do; motion and multipliers to ghosts in every step.

#include <algorithm>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::grow_arrays(int room) {
  held_.grow(room);
  ghost_values_.resize(static_cast<std::size_t>(room) * (kMotionSize + most_upward_));
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
  return 2 + 1 + 7 * held_.count(i);
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
  if (!ghosts_) return;
  forward_ = what;
  taut::forward_comm(*comm, this);
}

int FixTaut::motion_size() const {
  if (forward_ == Forward::kMultipliers) return 0;
  return forward_ == Forward::kVelocities || solve_->feedforward() ? 3 : 6;
}

// Motion: h v + h² f/m as a velocity, or v and f; and where chains are cut, multipliers of the atom's bonds
// to higher tags.
void FixTaut::write_values(int i) {
  double* const to = values_of(i);
  const double *v = atom->v[i], *f = atom->f[i];
  if (forward_ == Forward::kVelocities) {
    std::copy_n(v, 3, to);
  } else if (forward_ == Forward::kMotion && solve_->feedforward()) {
    const double factor = kick_ / update->dt * force->ftm2v / mass(i);
    for (int c = 0; c < 3; ++c) to[c] = v[c] + factor * f[c];
  } else if (forward_ == Forward::kMotion) {
    std::copy_n(v, 3, to);
    std::copy_n(f, 3, to + 3);
  }
  if (!cut_) return;
  const auto bonds = held_.of(i);
  const std::size_t first = held_.first_upward(i);
  for (int k = 0; k < most_upward_; ++k)
    to[kMotionSize + k] = first + k < bonds.size() ? bonds[first + k].past[0] : 0;
}

int FixTaut::pack_forward_comm(int n, int* list, double* buffer, int, int*) {
  double* next = buffer;
  for (int k = 0; k < n; ++k) {
    const int i = list[k];
    if (i < atom->nlocal) write_values(i);
    next = std::copy_n(values_of(i), motion_size(), next);
    if (forwards_multipliers()) next = std::copy_n(values_of(i) + kMotionSize, most_upward_, next);
  }
  return static_cast<int>(next - buffer);
}

void FixTaut::unpack_forward_comm(int n, int first, double* buffer) {
  const double* next = buffer;
  for (int i = first; i < first + n; ++i) {
    std::copy_n(next, motion_size(), values_of(i));
    next += motion_size();
    if (!forwards_multipliers()) continue;
    std::copy_n(next, most_upward_, values_of(i) + kMotionSize);
    next += most_upward_;
  }
}

void FixTaut::read_outer(bool next_step) {
  const auto& outer = solve_->pieces().outer;
  for (std::size_t b = 0; b < outer.size(); ++b) {
    const double lambda = received_multiplier(outer[b].ghost, outer[b].slot);
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
