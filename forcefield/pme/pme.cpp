#include "forcefield/pme/pme.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "md/units.hpp"

namespace taut {

Pme::Pme(const Nonbonded& nb)
    : alpha_(nb.pme->alpha),
      screening_(alpha_, *nb.cutoff, 1e-15),
      total_(nb.charge.sum()),
      constant_(-kCoulomb * alpha_ / std::sqrt(std::numbers::pi) * nb.charge.squaredNorm()),
      mesh_(std::sqrt(kCoulomb) * nb.charge, *nb.pme) {
  for (const auto& e : nb.exceptions)
    if (const double qq = nb.charge[e.i] * nb.charge[e.j]; qq != 0)
      excluded_.push_back({e.i, e.j, kCoulomb * qq});
}

void Pme::set_box(const Box& box) {
  background_ = -kCoulomb * std::numbers::pi * total_ * total_ / (2 * box.volume() * alpha_ * alpha_);
  mesh_.set_box(box);
}

void Pme::add_forces(const Vectors& x, Vectors& f) {
  mesh_.add_forces(x, f);
  subtract_excluded(x, f);
}

void Pme::subtract_excluded(const Vectors& x, Vectors& f) {
  excluded_energy_ = 0;
  excluded_virial_.setZero();
  const std::size_t n = excluded_.size();
  for (std::size_t first = 0; first < n; first += kScreenedPairs) {
    const std::size_t some = std::min<std::size_t>(n - first, kScreenedPairs);
    const Excluded* pair = excluded_.data() + first;
    ScreenedPairs pairs;
    for (std::size_t k = 0; k < some; ++k) pairs.r2[k] = (x.col(pair[k].i) - x.col(pair[k].j)).squaredNorm();
    screen(screening_, pairs);
    for (std::size_t k = 0; k < some; ++k) {
      const auto& [i, j, qq] = pair[k];
      const Vec3 r = x.col(i) - x.col(j), pull = qq * pairs.force[k] * r;
      excluded_energy_ -= qq * pairs.energy[k];
      excluded_virial_ -= r * pull.transpose();
      f.col(i) -= pull;
      f.col(j) += pull;
    }
  }
}

}  // namespace taut
