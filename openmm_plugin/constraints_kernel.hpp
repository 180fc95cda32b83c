#pragma once

#include <openmm/kernels.h>

#include <memory>

#include "openmm_plugin/held_dynamics.hpp"

namespace taut {

class TautIntegrator;

// Context.applyConstraints() and applyVelocityConstraints() by taut's projection: to round-off, whatever the
// tolerance, for any shape of molecule. OpenMM calls them for new velocities and for the minimiser, too.
class ProjectConstraints final : public OpenMM::ApplyConstraintsKernel {
 public:
  ProjectConstraints(const std::string& kernel, const OpenMM::Platform& of, const TautIntegrator& integrator)
      : ApplyConstraintsKernel(kernel, of), integrator_(integrator) {}
  void initialize(const OpenMM::System& system) override;
  void apply(OpenMM::ContextImpl& context, double tolerance) override;
  void applyToVelocities(OpenMM::ContextImpl& context, double tolerance) override;

 private:
  const TautIntegrator& integrator_;
  std::unique_ptr<BondProjection> projection_;
  std::vector<OpenMM::Vec3> x_, v_;
};

}  // namespace taut
