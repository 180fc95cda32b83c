// The part of the plug-in for one of OpenMM's platforms of devices, which it needs in the process before it is loaded.

#include <openmm/KernelFactory.h>
#include <openmm/Platform.h>

#if defined(TAUT_FOR_OPENCL)
#include <openmm/opencl/OpenCLContext.h>
#include <openmm/opencl/OpenCLKernelFactory.h>
#include <openmm/opencl/OpenCLPlatform.h>
using DevicePlatform = OpenMM::OpenCLPlatform;
using PlatformKernels = OpenMM::OpenCLKernelFactory;
#elif defined(TAUT_FOR_CUDA)
#include <openmm/cuda/CudaContext.h>
#include <openmm/cuda/CudaKernelFactory.h>
#include <openmm/cuda/CudaPlatform.h>
using DevicePlatform = OpenMM::CudaPlatform;
using PlatformKernels = OpenMM::CudaKernelFactory;
#elif defined(TAUT_FOR_HIP)
#include <openmm/hip/HipContext.h>
#include <openmm/hip/HipKernelFactory.h>
#include <openmm/hip/HipPlatform.h>
using DevicePlatform = OpenMM::HipPlatform;
using PlatformKernels = OpenMM::HipKernelFactory;
#endif

#include "openmm_plugin/constraints_kernel.hpp"
#include "openmm_plugin/device_step.hpp"

#define TAUT_EXPORT extern "C" __attribute__((visibility("default")))

namespace taut {

OpenMM::ComputeContext& DeviceStep::device_of(OpenMM::ContextImpl& context) {
  auto& data = *static_cast<DevicePlatform::PlatformData*>(context.getPlatformData());
  if (data.contexts.size() != 1)
    throw OpenMM::OpenMMException("a run on " + std::to_string(data.contexts.size()) +
                                  " devices: give the platform one, by the property DeviceIndex");
  return *data.contexts[0];
}

}  // namespace taut

namespace {

class Factory final : public OpenMM::KernelFactory {
 public:
  OpenMM::KernelImpl* createKernelImpl(std::string name, const OpenMM::Platform& platform,
                                       OpenMM::ContextImpl& context) const override {
    if (name == taut::TautStepKernel::Name()) return new taut::DeviceStep(name, platform);
    if (const auto* const integrator = dynamic_cast<taut::TautIntegrator*>(&context.getIntegrator()))
      return new taut::ProjectConstraints(name, platform, *integrator);
    return own_.createKernelImpl(name, platform, context);
  }

 private:
  PlatformKernels own_;
};

}  // namespace

TAUT_EXPORT void registerPlatforms() {}

TAUT_EXPORT void registerKernelFactories() {
  for (int n = 0; n < OpenMM::Platform::getNumPlatforms(); ++n) {
    OpenMM::Platform& platform = OpenMM::Platform::getPlatform(n);
    if (!dynamic_cast<DevicePlatform*>(&platform)) continue;
    platform.registerKernelFactory(taut::TautStepKernel::Name(), new Factory);
    platform.registerKernelFactory(OpenMM::ApplyConstraintsKernel::Name(), new Factory);
  }
}
