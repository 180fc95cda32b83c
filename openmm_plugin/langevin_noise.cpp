#include "openmm_plugin/langevin_noise.hpp"

#include <cmath>

#include "base/shares.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr int kBlock = 512;  // atoms that draw from one sequence, so that bits do not depend on threads

}  // namespace

LangevinNoise::LangevinNoise(const System& sys, double temperature, double friction, std::uint64_t seed,
                             double h)
    : h_(h), projector_(sys, Newton::Options{}, h), random_{seed} {
  set(sys, temperature, friction);
  restart(sys);
}

void LangevinNoise::set(const System& sys, double temperature, double friction) {
  friction_ = friction;
  const double c = std::exp(-friction * h_);
  width_ = ((1 - c * c) * kBoltzmann * temperature * sys.inv_mass).cwiseSqrt();
}

void LangevinNoise::restart(const System& sys) {
  half_jump_ = before_ = noise_ = Vectors::Zero(3, sys.atoms());
}

SolveStats LangevinNoise::project(const System& sys, const Vectors& x, Vectors& v) {
  if (sys.bonds.empty()) return {};
  scratch_.x = x;
  scratch_.v.swap(v);
  const SolveStats stats = projector_.project_velocities(sys, h_, scratch_);
  scratch_.v.swap(v);
  return {.worst_bond = stats.worst_bond, .failure = stats.failure};  // not a solve of the method
}

Bath::Draw LangevinNoise::draw(const System& sys, const Push& push, const State& s) {
  if (!acts()) return {};
  const double c = std::exp(-friction_ * h_);
  before_.swap(half_jump_);
  if (push.starts()) before_.setZero();
  const int blocks = (sys.atoms() + kBlock - 1) / kBlock;
  const std::uint64_t first_draw = random_.step * blocks;
  ++random_.step;
  in_shares(blocks, 1, [&](const Share& share) {
    for (int b = share.begin; b < share.end; ++b) {
      RandomOfStep random(random_.seed, Stream::kLangevin, first_draw + b);
      for (int i = kBlock * b; i < std::min(sys.atoms(), kBlock * (b + 1)); ++i) {
        const Vec3 v = s.v.col(i) + before_.col(i) + push.kick * sys.inv_mass[i] * s.f.col(i);
        half_jump_.col(i) = 0.5 * ((c - 1) * v + width_[i] * random.normal_vector());
      }
    }
  });
  const SolveStats stats = project(sys, s.x, half_jump_);
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int i = first; i < last; ++i)
      noise_.col(i) = sys.mass[i] / push.kick * (before_.col(i) + half_jump_.col(i));
  });
  return {stats, 0, &noise_, &before_};
}

}  // namespace taut
