#pragma once

#include <memory>
#include <vector>

#include "openmm_plugin/device_arrays.hpp"
#include "openmm_plugin/device_plan.hpp"
#include "openmm_plugin/step_kernel.hpp"
#include "openmm_plugin/taut_integrator.hpp"

namespace taut {

// The step on a device of OpenMM's common compute layer: positions, velocities, forces, and multipliers stay there.
// A step has one launch for the drift and one for each shape of cluster. The host reads nothing but the failures, once
// in kWatchEvery steps and at the end.
class DeviceStep final : public TautStepKernel {
 public:
  using TautStepKernel::TautStepKernel;
  static constexpr int kWatchEvery = 200;

  void initialize(OpenMM::ContextImpl& context, const TautIntegrator& integrator) override;
  void execute(OpenMM::ContextImpl& context, const TautIntegrator& integrator, int steps) override;
  void forget() override;
  void set_bath(double temperature, double friction) override;
  double kinetic_energy(OpenMM::ContextImpl& context) override;
  std::string save() override;
  void load(const std::string& kept) override;

 private:
  using Vectors = std::vector<OpenMM::Vec3>;
  struct Shape {
    DeviceShape plan;
    DeviceArray atoms, homes, lengths, gains, past;
    std::vector<DeviceArray> of_group;  // its plan, and room to work in
    OpenMM::ComputeKernel hold;
    int threads_of_cluster = 1;
  };

  // The platform's own: returns the context of its one device.
  static OpenMM::ComputeContext& device_of(OpenMM::ContextImpl& context);

  void make_kernels();
  void make_hold(Shape& shape);
  void add_group(Shape& shape);
  void start(OpenMM::ContextImpl& context);
  void step(OpenMM::ContextImpl& context);
  void hold(bool starts);
  void watch();
  void read_motion(OpenMM::ContextImpl& context);
  std::vector<OpenMM::ArrayInterface*> what_lasts();

  OpenMM::ContextImpl* context_ = nullptr;
  OpenMM::ComputeContext* device_ = nullptr;
  HoldSettings settings_;
  std::unique_ptr<BondProjection> projection_;
  DevicePlan plan_;
  std::vector<Shape> shapes_;
  OpenMM::ComputeKernel drift_;
  DeviceArray kept_, jumps_, failure_;
  Vectors x_, v_, saved_x_, saved_v_;
  KnownBox box_;
  int groups_ = -1;  // of forces
  int known_ = 0;    // multipliers that are known, at most 3; 0: the next step starts anew
  bool if_same_ =
      false;  // a checkpoint was loaded: it counts if the Context has its positions and velocities
  bool in_step_ = false;  // what changes the Context is the step itself
};

}  // namespace taut
