#include "ensembles/langevin.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

System with_bonds(System sys, bool wanted) {
  if (!wanted) sys.bonds.clear();
  sys.one_sided.clear();
  return sys;
}

constexpr std::uint64_t kStream = 0x6c616e676576696e;  // not the numbers the start was drawn from

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
      random_(settings.seed ^ kStream) {}

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
  for (int i = 0; i < sys.atoms(); ++i)
    heat_of_turning_ +=
        sys.mass[i] * (s.v.col(i) + 0.5 * before_.col(i)).dot(turned_.col(i) - before_.col(i));
  return stats;
}

Bath::Draw Langevin::draw(const System& sys, const Push& push, const State& s) {
  const double c = std::exp(-settings_.friction * h_);
  before_.swap(half_jump_);
  if (push.starts()) before_.setZero();
  SolveStats stats = account_for_turning(sys, s);
  const Vectors& f = forces_with_springs(sys, push, s, stats);
  for (int i = 0; i < sys.atoms(); ++i) {
    const double width = std::sqrt((1 - c * c) * kBoltzmann * settings_.temperature * sys.inv_mass[i]);
    const Vec3 v = s.v.col(i) + before_.col(i) + push.kick * sys.inv_mass[i] * f.col(i);
    half_jump_.col(i) = 0.5 * ((c - 1) * v + width * random_.normal_vector());
  }
  stats += project(s.x, half_jump_);
  if (settings_.hold_momentum) remove_momentum(sys, half_jump_);
  for (int i = 0; i < sys.atoms(); ++i)
    noise_.col(i) = sys.mass[i] / push.kick * (before_.col(i) + half_jump_.col(i));
  return {stats, &noise_, &before_};
}

Vectors Langevin::middle_velocity(const System& sys, const State& s) {
  State middle = s;
  half_kick(sys, h_, nullptr, middle);
  const SolveStats stats = project(middle.x, middle.v);
  if (!stats.converged())
    throw SimulationFailure(fmt::format("the temperature: {}", in_words(stats.failure)));
  return middle.v;
}

}  // namespace taut
