// The plug-in: OpenMM loads it by Platform::loadPluginsFromDirectory() and calls registerKernelFactories().

#include <openmm/KernelFactory.h>
#include <openmm/OpenMMException.h>
#include <openmm/Platform.h>
#include <openmm/internal/ContextImpl.h>
#include <openmm/reference/ReferenceKernelFactory.h>
#include <openmm/reference/ReferencePlatform.h>
#include <openmm/serialization/SerializationNode.h>
#include <openmm/serialization/SerializationProxy.h>

#include <cstdlib>

#include "openmm_plugin/constraints_kernel.hpp"
#include "openmm_plugin/host_step.hpp"

#define TAUT_EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using taut::HoldSettings;
using taut::TautIntegrator;

class StepFactory final : public OpenMM::KernelFactory {
 public:
  OpenMM::KernelImpl* createKernelImpl(std::string name, const OpenMM::Platform& platform,
                                       OpenMM::ContextImpl&) const override {
    return new taut::HostStep(name, platform);
  }
};

// applyConstraints() of Contexts with a TautIntegrator. All others keep OpenMM's own.
class ConstraintsFactory final : public OpenMM::KernelFactory {
 public:
  OpenMM::KernelImpl* createKernelImpl(std::string name, const OpenMM::Platform& platform,
                                       OpenMM::ContextImpl& context) const override {
    if (const auto* const integrator = dynamic_cast<TautIntegrator*>(&context.getIntegrator()))
      return new taut::ProjectConstraints(name, platform, *integrator);
    return reference_.createKernelImpl(name, platform, context);
  }

 private:
  OpenMM::ReferenceKernelFactory reference_;
};

// <Integrator type="TautIntegrator" stepSize=".." method=".." ..>
//   <Options tolerance=".."/><Bonds><Bond p1="0" p2="1" d="0.1"/>..</Bonds>
// </Integrator>
class Proxy final : public OpenMM::SerializationProxy {
 public:
  Proxy() : SerializationProxy("TautIntegrator") {}

  void serialize(const void* object, OpenMM::SerializationNode& node) const override {
    const auto& integrator = *static_cast<const TautIntegrator*>(object);
    const HoldSettings& settings = integrator.settings();
    node.setIntProperty("version", 1);
    node.setDoubleProperty("stepSize", settings.h);
    node.setStringProperty("method", settings.method);
    node.setDoubleProperty("temperature", settings.temperature);
    node.setDoubleProperty("friction", settings.friction);
    node.setStringProperty("randomSeed", std::to_string(settings.seed));
    node.setIntProperty("integrationForceGroups", integrator.getIntegrationForceGroups());
    OpenMM::SerializationNode& options = node.createChildNode("Options");
    for (const auto& [name, value] : settings.options) options.setStringProperty(name, value);
    OpenMM::SerializationNode& bonds = node.createChildNode("Bonds");
    for (const auto& [i, j, length] : settings.bonds)
      bonds.createChildNode("Bond").setIntProperty("p1", i).setIntProperty("p2", j).setDoubleProperty("d",
                                                                                                      length);
  }

  void* deserialize(const OpenMM::SerializationNode& node) const override {
    if (node.getIntProperty("version") != 1)
      throw OpenMM::OpenMMException("TautIntegrator: this version of its XML is not known; expected 1");
    HoldSettings settings;
    settings.h = node.getDoubleProperty("stepSize");
    settings.method = node.getStringProperty("method", settings.method);
    settings.temperature = node.getDoubleProperty("temperature", 0);
    settings.friction = node.getDoubleProperty("friction", 0);
    settings.seed = std::strtoull(node.getStringProperty("randomSeed", "0").c_str(), nullptr, 10);
    for (const OpenMM::SerializationNode& child : node.getChildren())
      for (const auto& [name, value] : child.getProperties()) settings.options[name] = value;
    for (const OpenMM::SerializationNode& child : node.getChildren())
      for (const OpenMM::SerializationNode& bond : child.getChildren())
        settings.bonds.push_back(
            {bond.getIntProperty("p1"), bond.getIntProperty("p2"), bond.getDoubleProperty("d")});
    auto* const integrator = new TautIntegrator(settings);
    integrator->setIntegrationForceGroups(node.getIntProperty("integrationForceGroups", -1));
    return integrator;
  }
};

// Returns null, or why `work` was refused.
const char* refusal_of(const std::function<void()>& work) {
  static std::string last;
  try {
    work();
  } catch (const std::exception& wrong) {
    last = wrong.what();
    return last.c_str();
  }
  return nullptr;
}

}  // namespace

TAUT_EXPORT void registerPlatforms() {}

TAUT_EXPORT void registerKernelFactories() {
  for (int n = 0; n < OpenMM::Platform::getNumPlatforms(); ++n) {
    OpenMM::Platform& platform = OpenMM::Platform::getPlatform(n);
    // CPU is one, too. A platform of devices crashes unless its integrator prepares it, as device_step.cpp does.
    if (!dynamic_cast<OpenMM::ReferencePlatform*>(&platform)) continue;
    platform.registerKernelFactory(taut::TautStepKernel::Name(), new StepFactory);
    platform.registerKernelFactory(OpenMM::ApplyConstraintsKernel::Name(), new ConstraintsFactory);
  }
  OpenMM::SerializationProxy::registerProxy(typeid(TautIntegrator), new Proxy);
}

// For Python, whose openmm.Integrator knows no temperature.
TAUT_EXPORT const char* taut_set_bath(OpenMM::Integrator* integrator, double temperature, double friction) {
  return refusal_of([&] { dynamic_cast<TautIntegrator&>(*integrator).set_bath(temperature, friction); });
}
TAUT_EXPORT const char* taut_temperature(OpenMM::Integrator* integrator, double* kelvin) {
  return refusal_of([&] { *kelvin = dynamic_cast<TautIntegrator&>(*integrator).temperature(); });
}
TAUT_EXPORT void taut_set_seed(OpenMM::Integrator* integrator, std::uint64_t seed) {
  dynamic_cast<TautIntegrator&>(*integrator).set_seed(seed);
}
