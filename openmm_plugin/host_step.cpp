#include "openmm_plugin/host_step.hpp"

#include <openmm/Platform.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace taut {
namespace {

using OpenMM::Vec3;

void copy(const double* from, std::vector<Vec3>& to) {
  std::memcpy(static_cast<void*>(to.data()), from, to.size() * sizeof(Vec3));
}
void copy(const std::vector<Vec3>& from, double* to) {
  std::memcpy(to, static_cast<const void*>(from.data()), from.size() * sizeof(Vec3));
}

// As many threads as the platform has of its own on the host; else one.
int threads_of(OpenMM::ContextImpl& context) {
  const OpenMM::Platform& platform = context.getPlatform();
  const auto& names = platform.getPropertyNames();
  if (std::find(names.begin(), names.end(), "Threads") == names.end()) return 1;
  return std::max(1, std::atoi(platform.getPropertyValue(context.getOwner(), "Threads").c_str()));
}

}  // namespace

void HostStep::initialize(OpenMM::ContextImpl& context, const TautIntegrator& integrator) {
  HoldSettings settings = integrator.settings();
  settings.seed = integrator.seed_in_use();
  context_ = &context;
  friction_ = settings.friction;
  vectors_.resize(context.getSystem().getNumParticles());
  dynamics_.emplace(held_bonds(context.getSystem(), settings), settings, threads_of(context));
}

void HostStep::forget() {
  if (!in_step_) known_ = Known::kNothing;
}

void HostStep::set_bath(double temperature, double friction) {
  if ((friction > 0) != (friction_ > 0)) forget();
  friction_ = friction;
  dynamics_->set_bath(temperature, friction);
}

double HostStep::kinetic_energy(OpenMM::ContextImpl& context) {
  if (known_ == Known::kAll && !in_step_) return dynamics_->kinetic_energy();
  context.getVelocities(vectors_);
  double twice = 0;
  for (int i = 0; i < context.getSystem().getNumParticles(); ++i)
    twice += context.getSystem().getParticleMass(i) * vectors_[i].dot(vectors_[i]);
  return 0.5 * twice;
}

void HostStep::place(const double* x) {
  copy(x, vectors_);
  context_->setPositions(vectors_);
  context_->computeVirtualSites();
  placed_ = true;
}

void HostStep::read_motion() {
  context_->getPositions(vectors_);
  copy(vectors_, dynamics_->x());
  context_->getVelocities(vectors_);
  copy(vectors_, dynamics_->v());
}

void HostStep::update(double t, double* x, double* v) {
  context_->setTime(t);
  place(x);
  copy(v, vectors_);
  context_->setVelocities(vectors_);
  if (context_->updateContextState()) {
    context_->getPositions(vectors_);
    copy(vectors_, x);
  }
  context_->getVelocities(vectors_);
  copy(vectors_, v);
}

void HostStep::forces(double t, const double* x, double* f) {
  context_->setTime(t);
  if (!placed_) place(x);
  context_->calcForcesAndEnergy(true, false, groups_);
  context_->getForces(vectors_);
  copy(vectors_, f);
  placed_ = false;
}

// To single precision, which is what a device may keep. Virtual sites have no motion of their own.
bool HostStep::motion_is_the_same() {
  const auto same = [&](const double* kept) {
    for (int i = 0; i < static_cast<int>(vectors_.size()); ++i) {
      if (context_->getSystem().getParticleMass(i) == 0) continue;
      for (int d = 0; d < 3; ++d) {
        const double a = vectors_[i][d], b = kept[3 * i + d];
        if (!(std::abs(a - b) <= 1e-7 * std::abs(b))) return false;
      }
    }
    return true;
  };
  context_->getPositions(vectors_);
  if (!same(dynamics_->x())) return false;
  context_->getVelocities(vectors_);
  return same(dynamics_->v());
}

void HostStep::start(double t) {
  read_motion();
  placed_ = false;
  dynamics_->start(t, *this);
  copy(dynamics_->v(), vectors_);
  context_->setVelocities(vectors_);
}

void HostStep::execute(OpenMM::ContextImpl& context, const TautIntegrator& integrator, int steps) {
  context_ = &context;
  if (integrator.getIntegrationForceGroups() != groups_) known_ = Known::kNothing;
  groups_ = integrator.getIntegrationForceGroups();
  if (!box_.is_the_same(*context_) && known_ == Known::kAll) known_ = Known::kNothing;
  if (known_ == Known::kIfSame) known_ = motion_is_the_same() ? Known::kAll : Known::kNothing;
  const bool start_anew = known_ != Known::kAll;
  struct InStep {
    HostStep& step;
    explicit InStep(HostStep& of) : step(of) { step.in_step_ = true; }
    ~InStep() { step.in_step_ = false; }
  } in_step(*this);
  known_ = Known::kNothing;  // until all steps are taken: an exception leaves it so
  double t = context.getTime();
  if (start_anew && steps > 0) start(t);
  for (int n = 0; n < steps; ++n) {
    dynamics_->step(t, *this);
    t += integrator.getStepSize();
    copy(dynamics_->v(), vectors_);
    context.setVelocities(vectors_);
    context.setTime(t);
    context.setStepCount(context.getStepCount() + 1);
  }
  box_.is_the_same(*context_);
  if (steps > 0 || !start_anew) known_ = Known::kAll;
}

std::string HostStep::save() {
  return known_ == Known::kAll ? dynamics_->save() : std::string();
}

void HostStep::load(const std::string& kept) {
  known_ = Known::kNothing;
  if (kept.empty() || kept.compare(0, std::strlen(kKeptByDevice), kKeptByDevice) == 0) return;
  dynamics_->load(kept);
  known_ = Known::kIfSame;
}

}  // namespace taut
