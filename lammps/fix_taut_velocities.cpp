// Velocities lose their part along the bonds: before the first step, and at every full step where that is
// asked for.

#include <algorithm>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::read_velocities() {
  taut::State& s = solve_->state();
  const auto& images = solve_->local().images;
  for (std::size_t a = 0; a < images.size(); ++a) {
    const auto v = Eigen::Map<const taut::Vec3>(motion_of(images[a].atom));
    s.v.col(static_cast<Eigen::Index>(a)) = v;
  }
}

void FixTaut::write_velocities() {
  const taut::State& s = solve_->state();
  const auto& images = solve_->local().images;
  for (std::size_t a = 0; a < images.size(); ++a)
    if (const int i = images[a].atom; i < atom->nlocal)
      Eigen::Map<taut::Vec3>(atom->v[i]) = s.v.col(static_cast<Eigen::Index>(a));
}

// Before the first step: v loses its part along the bonds, M⁻¹Jᵀμ. Where chains are cut, processors tell each
// other their μ, in the place of λ, until they agree.
void FixTaut::project_velocities(int rounds) {
  std::ranges::fill(solve_->outer_lambda, 0);
  forward_comm(Forward::kVelocities);
  for (int n = 0; n < rounds; ++n) {
    read_velocities();
    if (n > 0) {
      forward_comm(Forward::kMultipliers);
      read_outer(false);
    }
    require_solved(solve_->project_velocities_at_start());
  }
  write_velocities();
}

// RATTLE's velocities beside SHAKE's positions: v loses its part along the bonds, M⁻¹Jᵀμ, and f gains
// −(2/h)Jᵀμ, so that the coming step, v + ½h M⁻¹f, is what it was.
void FixTaut::final_integrate() {
  const auto& images = solve_->local().images;
  cleared_from_.resize(3 * images.size());
  for (std::size_t a = 0; a < images.size(); ++a)
    if (images[a].atom < atom->nlocal) std::copy_n(atom->v[images[a].atom], 3, &cleared_from_[3 * a]);
  forward_comm(Forward::kVelocities);
  read_velocities();
  require_solved(solve_->project_velocities());
  write_velocities();
  for (std::size_t a = 0; a < images.size(); ++a) {
    const int i = images[a].atom;
    if (i >= atom->nlocal || is_fixed(i)) continue;
    const double factor = 2 / (update->dt * solve_->system().inv_mass[static_cast<Eigen::Index>(a)]);
    for (int c = 0; c < 3; ++c) atom->f[i][c] -= factor * (atom->v[i][c] - cleared_from_[3 * a + c]);
  }
}

}  // namespace LAMMPS_NS
