#include "openmm_plugin/constraints_kernel.hpp"

#include <openmm/internal/ContextImpl.h>

#include "openmm_plugin/taut_integrator.hpp"

namespace taut {

void ProjectConstraints::initialize(const OpenMM::System& system) {
  x_.resize(system.getNumParticles());
  v_.resize(system.getNumParticles());
  in_openmm_words(
      [&] { projection_ = std::make_unique<BondProjection>(held_bonds(system, integrator_.settings())); });
}

void ProjectConstraints::apply(OpenMM::ContextImpl& context, double) {
  context.getPositions(x_);
  in_openmm_words([&] { projection_->positions(&x_[0][0]); });
  context.setPositions(x_);
  context.computeVirtualSites();
}

void ProjectConstraints::applyToVelocities(OpenMM::ContextImpl& context, double) {
  context.getPositions(x_);
  context.getVelocities(v_);
  in_openmm_words([&] { projection_->velocities(&x_[0][0], &v_[0][0]); });
  context.setVelocities(v_);
}

}  // namespace taut
