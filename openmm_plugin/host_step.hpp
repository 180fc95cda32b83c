#pragma once

#include <optional>

#include "openmm_plugin/step_kernel.hpp"
#include "openmm_plugin/taut_integrator.hpp"

namespace taut {

// The step on the host, for any platform: the platform computes forces, taut does the rest in double
// precision. A platform that computes on a device sends its forces here and gets positions back in every step.
class HostStep final : public TautStepKernel, private Engine {
 public:
  using TautStepKernel::TautStepKernel;

  void initialize(OpenMM::ContextImpl& context, const TautIntegrator& integrator) override;
  void execute(OpenMM::ContextImpl& context, const TautIntegrator& integrator, int steps) override;
  void forget() override;
  void set_bath(double temperature, double friction) override;
  double kinetic_energy(OpenMM::ContextImpl& context) override;
  std::string save() override;
  void load(const std::string& kept) override;

 private:
  using Vectors = std::vector<OpenMM::Vec3>;
  enum class Known {
    kNothing,  // the next step starts anew
    kIfSame,   // a checkpoint was loaded: all, if the Context has the positions and velocities of `dynamics_`
    kAll       // `dynamics_` has the Context's positions and velocities, and their forces
  };

  void update(double t, double* x, double* v) override;
  void forces(double t, const double* x, double* f) override;
  void place(const double* x);
  void read_motion();
  bool motion_is_the_same();
  void start(double t);

  std::optional<HeldDynamics> dynamics_;
  OpenMM::ContextImpl* context_ = nullptr;
  Known known_ = Known::kNothing;
  bool in_step_ = false;  // what changes the Context is the step itself
  bool placed_ = false;   // the Context has the positions of the step
  int groups_ = -1;       // of forces
  double friction_ = 0;   // of the thermostat [1/ps]
  Vectors vectors_;
  KnownBox box_;
};

}  // namespace taut
