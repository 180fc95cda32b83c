#pragma once

#include <openmm/KernelImpl.h>
#include <openmm/System.h>
#include <openmm/internal/ContextImpl.h>

#include <algorithm>
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

// Remembers the Context's box.
class KnownBox {
 public:
  // Returns whether the box is that of the last call.
  bool is_the_same(OpenMM::ContextImpl& context) {
    OpenMM::Vec3 now[3];
    context.getPeriodicBoxVectors(now[0], now[1], now[2]);
    const bool same = std::equal(now, now + 3, box_);
    std::copy(now, now + 3, box_);
    return same;
  }

 private:
  OpenMM::Vec3 box_[3];
};

}  // namespace taut
