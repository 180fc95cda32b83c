#include "ensembles/langevin.hpp"

#include <cmath>
#include <numeric>

#include "base/shares.hpp"
#include "ensembles/noise.hpp"
#include "md/diagnosis.hpp"
#include "md/observables.hpp"
#include "md/step_parts.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr int kBlock =
    512;  // atoms whose heat is summed by one thread: rounding does not depend on their number

System with_bonds(System sys, bool wanted) {
  if (!wanted) sys.bonds.clear();
  return sys;
}

}  // namespace

Langevin::Langevin(const System& sys, const Settings& settings, double h)
    : settings_(settings),
      h_(h),
      drift_(with_bonds(sys, settings.springs == nullptr)),
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

void Langevin::initialize(const Dynamics& dynamics, double h, State& s) {
  s.f.resize(3, dynamics.sys.atoms());
  dynamics.forces.evaluate(dynamics.sys, s);  // f = F(x)
  s.F = s.f;
  Push push = Push::at_start(h);
  SolveStats stats = draw(dynamics, push, s);  // ½Δ of the first drift
  push.noise = &noise_;
  stats += dynamics.add_forces(push, s);  // f = F + C
  demand_converged(dynamics.sys, s, stats, 0);
}

SolveStats Langevin::advance(const Dynamics& dynamics, double h, State& s) {
  const System& sys = dynamics.sys;
  Push push = Push::between_steps(h);
  dynamics.set_off(h, s);                               // v½ of anchors that move
  half_kick_and_drift(sys, h, &half_jump_, s);          // u = v + (h/2) M⁻¹f + ½Δ, x' = x + hu
  s.t += h;                                             // forces that depend on time act at the new one
  SolveStats stats = dynamics.project_positions(h, s);  // σ(x') = 0, and u by as much over h
  account.heat += dynamics.bath.move_box(sys, s);       // a barostat scales box, x' and u
  dynamics.forces.evaluate(sys, s);                     // f' = F(x')
  renew_forces(h, sys, &half_jump_, s);                 // work of F and F', heat Σ mu·Δ; F is F'
  stats += draw(dynamics, push, s);                     // the Δ' to come, from u + ½Δ + h M⁻¹f'
  account.heat += heat_of_turning_;                     // less what turned bonds took of ½Δ
  push.noise = &noise_;                                 // ½M(Δ + Δ')/h
  stats += dynamics.add_forces(push, s);                // f' = F' + C'
  half_kick(sys, h, &before_, s);                       // v' = u + ½Δ + (h/2) M⁻¹f'
  stats += dynamics.project_velocities(h, s);           // σ̇ = Jv' = 0
  if (stats.held()) account.heat += dynamics.after_step(h, s);  // barostat, steering
  return stats;
}

void Langevin::set_friction(double friction) {
  settings_.friction = friction;
  set_temperature(settings_.temperature);
}

void Langevin::set_temperature(double kelvin) {
  settings_.temperature = kelvin;
  const double c = std::exp(-h_ * settings_.friction);
  width_ = ((1 - c * c) * kBoltzmann * kelvin * drift_.tangent().inv_mass).cwiseSqrt();
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
  if (drift_.tangent().bonds.empty()) return {};
  turned_ = before_;
  const SolveStats stats = drift_.project(h_, s.x, turned_);
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

// Draws the Δ that follows on s.v, the velocity of the drift, and `push`. The one before is kept.
SolveStats Langevin::draw(const Dynamics& dynamics, const Push& push, const State& s) {
  const System& sys = dynamics.sys;
  const PartScope here(StepPart::kThermostat);
  if (!settings_.course.empty()) set_temperature(settings_.course.at(s.t));
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
  if (dynamics.anchors) dynamics.anchors->hold_still(half_jump_);
  stats += drift_.project(h_, s.x, half_jump_);
  if (settings_.hold_momentum) remove_momentum(sys, half_jump_);
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int i = first; i < last; ++i)
      noise_.col(i) = sys.mass[i] / push.kick * (before_.col(i) + half_jump_.col(i));
  });
  return stats;
}

}  // namespace taut
