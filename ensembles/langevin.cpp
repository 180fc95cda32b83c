#include "ensembles/langevin.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/shares.hpp"
#include "ensembles/noise.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr int kBlock =
    512;  // atoms whose heat is summed by one thread: rounding does not depend on their number

System with_bonds(System sys, bool wanted) {
  if (!wanted) sys.bonds.clear();
  sys.one_sided.clear();
  return sys;
}

}  // namespace

Langevin::Langevin(const System& sys, const Settings& settings, double h)
    : settings_(settings),
      h_(h),
      tangent_(with_bonds(sys, settings.springs == nullptr)),
      projector_(tangent_, {}, h),
      half_jump_(Vectors::Zero(3, sys.atoms())),
      before_(half_jump_),
      noise_(half_jump_),
      turned_(half_jump_),
      random_{settings.seed},
      width_(sys.inv_mass),
      heats_((sys.atoms() + kBlock - 1) / kBlock),
      normal_((3 * sys.atoms() + kNoiseBlock - 1) / kNoiseBlock * kNoiseBlock) {
  set_temperature(settings.temperature);
}

void Langevin::set_friction(double friction) {
  settings_.friction = friction;
  set_temperature(settings_.temperature);
}

void Langevin::set_temperature(double kelvin) {
  settings_.temperature = kelvin;
  const double c = std::exp(-h_ * settings_.friction);
  width_ = ((1 - c * c) * kBoltzmann * kelvin * tangent_.inv_mass).cwiseSqrt();
}

SolveStats Langevin::project(const Vectors& x, Vectors& v) {
  if (tangent_.bonds.empty()) return {};
  scratch_.x = x;
  scratch_.v.swap(v);
  const SolveStats stats = projector_.project_velocities(tangent_, h_, scratch_);
  scratch_.v.swap(v);
  return {.worst_bond = stats.worst_bond, .failure = stats.failure};  // not a solve of the method
}

const Vectors& Langevin::forces_with_springs(const System& sys, const Push& push, const State& s,
                                             SolveStats& stats) {
  if (!settings_.springs) return s.f;
  scratch_ = s;
  stats += settings_.springs->add_forces(sys, push, scratch_);
  return scratch_.f;
}

// s.v is the velocity of the drift, v_half + a.
SolveStats Langevin::account_for_turning(const System& sys, const State& s) {
  heat_of_turning_ = 0;
  if (tangent_.bonds.empty()) return {};
  turned_ = before_;
  const SolveStats stats = project(s.x, turned_);
  in_shares(static_cast<int>(heats_.size()), 1, [&](const Share& share) {
    for (int b = share.begin; b < share.end; ++b) {
      heats_[b] = 0;
      for (int i = kBlock * b; i < std::min(sys.atoms(), kBlock * (b + 1)); ++i)
        heats_[b] += sys.mass[i] * (s.v.col(i) + 0.5 * before_.col(i)).dot(turned_.col(i) - before_.col(i));
    }
  });
  heat_of_turning_ = std::accumulate(heats_.begin(), heats_.end(), 0.0);
  return stats;
}

Bath::Draw Langevin::draw(const System& sys, const Push& push, const State& s) {
  const double c = std::exp(-settings_.friction * h_);
  before_.swap(half_jump_);
  if (push.starts()) before_.setZero();
  SolveStats stats = account_for_turning(sys, s);
  const Vectors& f = forces_with_springs(sys, push, s, stats);
  fill_with_noise(random_.seed, random_.step++, normal_);
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const Eigen::Map<const Vec3> normal(normal_.data() + 3 * i);
      const Vec3 v = s.v.col(i) + before_.col(i) + push.kick * sys.inv_mass[i] * f.col(i);
      half_jump_.col(i) = 0.5 * ((c - 1) * v + width_[i] * normal);
    }
  });
  stats += project(s.x, half_jump_);
  if (settings_.hold_momentum) remove_momentum(sys, half_jump_);
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int i = first; i < last; ++i)
      noise_.col(i) = sys.mass[i] / push.kick * (before_.col(i) + half_jump_.col(i));
  });
  return {stats, heat_of_turning_, &noise_, &before_};
}

Vectors Langevin::middle_velocity(const System& sys, const State& s) {
  State middle = s;
  half_kick(sys, h_, nullptr, middle);
  return tangent_velocity(middle);
}

Vectors Langevin::tangent_velocity(const State& s) {
  Vectors v = s.v;
  const SolveStats stats = project(s.x, v);
  if (!stats.converged())
    throw SimulationFailure(fmt::format("the temperature: {}", in_words(stats.failure)));
  return v;
}

}  // namespace taut
