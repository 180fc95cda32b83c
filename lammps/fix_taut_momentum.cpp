// Momentum of cut chains. Of a bond between two processors each finds the multiplier itself, λ and λ', and
// applies it to its own atom: total momentum is off by h (λ' − λ) r. λ of the lower tag's processor comes
// with the next forward communication; the atom of the higher tag then gets what it lacks as a velocity,
// before it says where it would go. So momentum is that of one λ a bond, but for the last two steps, and
// exactly so when a run ends; nothing is communicated for it but once when lists are built and at the end of
// a run.

#include <algorithm>
#include <cmath>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

// After a solve. acted: how long its forces will have when the step ends; the next one begins with ½h more.
void FixTaut::remember_shared(double acted) {
  acted_ = acted;
  const auto& shared = solve_->local().shared;
  shared_r_.resize(3, static_cast<Eigen::Index>(shared.size()));
  for (Eigen::Index b = 0; b < shared_r_.cols(); ++b) {
    const auto& [i, j, d] = solve_->system().bonds[shared[b]];
    shared_r_.col(b) = solve_->state().x.col(j) - solve_->state().x.col(i);
  }
}

// λ' − λ, after the other processor's multiplier has come.
double FixTaut::difference_of(int shared) const {
  const auto& [of_ghost, own] = solve_->local().places[shared];
  return of_ghost->told - own->told;
}

// |σ|/d² of the next step that this difference leaves.
double FixTaut::left_by(int shared) const {
  const auto& [i, j, d] = solve_->system().bonds[shared];
  const auto& inv_mass = solve_->system().inv_mass;
  return update->dt * update->dt * std::abs(difference_of(shared)) * (inv_mass[i] + inv_mass[j]);
}

// In a step's last exchange the multipliers come that its exchanges but one have led to.
void FixTaut::look_before_last_exchange() {
  for (const int shared : solve_->local().shared)
    left_.one_exchange_less = std::max(left_.one_exchange_less, left_by(shared));
}

void FixTaut::compare_shared(double impulse_time) {
  if (shared_r_.cols() > 0) mismatch_ = 0;
  for (Eigen::Index b = 0; b < shared_r_.cols(); ++b) {
    const int shared = solve_->local().shared[b];
    const double difference = difference_of(shared);
    left_.now = std::max(left_.now, left_by(shared));
    mismatch_ = std::max(mismatch_, std::abs(difference) * solve_->system().bonds[shared].length);
    missing_impulses_.col(b) += impulse_time * difference * shared_r_.col(b);
  }
  shared_r_.resize(3, 0);
}

void FixTaut::give_missing_impulses() {
  for (Eigen::Index b = 0; b < missing_impulses_.cols(); ++b) {
    const int j = solve_->system().bonds[solve_->local().shared[b]].j;
    Eigen::Map<taut::Vec3>(atom->v[solve_->local().images[j].atom]) +=
        solve_->system().inv_mass[j] * missing_impulses_.col(b);
  }
  missing_impulses_.setZero();
}

}  // namespace LAMMPS_NS
