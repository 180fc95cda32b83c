// What travels: held bonds with their atoms and to ghosts when atoms change processors, motion and
// multipliers to ghosts in every step.

#include <algorithm>
#include <cmath>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::grow_arrays(int room) {
  held_.grow(room);
  inbox_.resize(static_cast<std::size_t>(room) * (kNewsRoom + most_upward_));
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
  keep_past();
  return 2 + 1 + 7 * held_.count(i);
}

int FixTaut::pack_restart(int i, double* buffer) {
  keep_past();
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

void FixTaut::tell(News news) {
  if (!ghosts_) return;
  news_ = news;
  comm->forward_comm_fix(this);
}

// Motion: w, or v and f; and where chains are cut, multipliers of the atom's bonds to higher tags.
void FixTaut::write_news(int i, double* to) const {
  const double *v = atom->v[i], *f = atom->f[i];
  if (news_ == News::kVelocities) {
    std::copy_n(v, 3, to);
  } else if (news_ == News::kMotion && solve_->feedforward()) {
    const double factor = kick_ / update->dt * force->ftm2v / mass(i);
    for (int c = 0; c < 3; ++c) to[c] = v[c] + factor * f[c];
  } else if (news_ == News::kMotion) {
    std::copy_n(v, 3, to);
    std::copy_n(f, 3, to + 3);
  }
  if (!cut_) return;
  const auto bonds = held_.of(i);
  const std::size_t first = held_.first_upward(i);
  for (int k = 0; k < most_upward_; ++k)
    to[kNewsRoom + k] = first + k < bonds.size() ? bonds[first + k].past[0] : 0;
}

int FixTaut::pack_forward_comm(int n, int* list, double* buffer, int, int*) {
  double news[64];
  double* next = buffer;
  for (int k = 0; k < n; ++k) {
    const int i = list[k];
    const double* from = &inbox_[static_cast<std::size_t>(i) * comm_forward];
    if (i < atom->nlocal) {
      write_news(i, news);
      from = news;
    }
    next = std::copy_n(from, numbers_of_motion(), next);
    if (tells_multipliers()) next = std::copy_n(from + kNewsRoom, most_upward_, next);
  }
  return static_cast<int>(next - buffer);
}

void FixTaut::unpack_forward_comm(int n, int first, double* buffer) {
  const double* next = buffer;
  for (int i = first; i < first + n; ++i) {
    double* const to = &inbox_[static_cast<std::size_t>(i) * comm_forward];
    std::copy_n(next, numbers_of_motion(), to);
    next += numbers_of_motion();
    if (!tells_multipliers()) continue;
    std::copy_n(next, most_upward_, to + kNewsRoom);
    next += most_upward_;
  }
}

int FixTaut::numbers_of_motion() const {
  if (news_ == News::kMultipliers) return 0;
  return news_ == News::kVelocities || solve_->feedforward() ? 3 : 6;
}

void FixTaut::hear_outer(bool next_step) {
  const auto& outer = solve_->pieces().outer;
  for (std::size_t b = 0; b < outer.size(); ++b) {
    const double told =
        inbox_[static_cast<std::size_t>(outer[b].teller) * comm_forward + kNewsRoom + outer[b].slot];
    auto& past = outer[b].source->past;
    if (!next_step) {
      solve_->outer_lambda[b] = told;
    } else {
      if (!outer_is_fresh_) std::copy_backward(past.begin(), past.end() - 1, past.end());
      past[0] = told;
    }
  }
}

// Two processors that share a bond find its multiplier each; what they differ by is what momentum is off by.
void FixTaut::see_mismatch() {
  mismatch_ = 0;
  for (const auto& [bond, teller, slot] : solve_->pieces().shared) {
    const double told = inbox_[static_cast<std::size_t>(teller) * comm_forward + kNewsRoom + slot];
    const double own = solve_->pieces().places[bond][1]->past[0];
    mismatch_ = std::max(mismatch_, std::abs(told - own) * solve_->system().bonds[bond].length);
  }
}

}  // namespace LAMMPS_NS
