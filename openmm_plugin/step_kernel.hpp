#pragma once

#include <openmm/KernelImpl.h>
#include <openmm/System.h>
#include <openmm/internal/ContextImpl.h>

#include <string>

namespace taut {

class TautIntegrator;

// What a device keeps begins so; other platforms start anew from it, as a device does from theirs.
constexpr const char* kKeptByDevice = "device\n";

// What a platform does for a TautIntegrator.
class TautStepKernel : public OpenMM::KernelImpl {
 public:
  static std::string Name() { return "IntegrateTautStep"; }
  using KernelImpl::KernelImpl;

  virtual void initialize(OpenMM::ContextImpl& context, const TautIntegrator& integrator) = 0;
  virtual void execute(OpenMM::ContextImpl& context, const TautIntegrator& integrator, int steps) = 0;
  // The user has changed positions, velocities, parameters or forces. The kernel's own calls are ignored.
  virtual void forget() = 0;
  virtual void set_bath(double temperature, double friction) = 0;
  virtual double kinetic_energy(OpenMM::ContextImpl& context) = 0;
  // What the next step needs besides positions and velocities; empty where it needs nothing.
  virtual std::string save() = 0;
  virtual void load(const std::string& kept) = 0;
};

}  // namespace taut
