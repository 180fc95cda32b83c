#include "systems/openmm_twin.hpp"

#include <OpenMM.h>
#include <fmt/format.h>

#include <mutex>
#include <vector>

#include "md/errors.hpp"
#include "systems/openmm_files.hpp"

namespace taut {
namespace {

void build_integrator(OpenMM::CustomIntegrator& twin) {
  twin.addPerDofVariable("x1", 0);
  twin.addComputePerDof("v", "v + 0.5*dt*f/m");
  twin.addComputePerDof("x", "x + dt*v");
  twin.addComputePerDof("x1", "x");
  twin.addConstrainPositions();
  twin.addComputePerDof("v", "v + 0.5*dt*f/m + (x - x1)/dt");
  twin.addConstrainVelocities();
}

OpenMM::Platform& platform_by_name(const std::string& name) {
  static std::once_flag plugins;  // Reference is built in, the others are plug-ins
  if (name != "Reference")
    std::call_once(plugins, [] {
      OpenMM::Platform::loadPluginsFromDirectory(OpenMM::Platform::getDefaultPluginsDirectory());
    });
  try {
    return OpenMM::Platform::getPlatformByName(name);
  } catch (const OpenMM::OpenMMException&) {
    throw InputError(fmt::format("OpenMM has no platform {} among its plug-ins in {}", name,
                                 OpenMM::Platform::getDefaultPluginsDirectory()));
  }
}

std::vector<OpenMM::Vec3> to_openmm(const Vectors& from) {
  std::vector<OpenMM::Vec3> to;
  to.reserve(from.cols());
  for (const auto& c : from.colwise()) to.emplace_back(c.x(), c.y(), c.z());
  return to;
}

}  // namespace

struct OpenMMTwin::Impl {
  std::unique_ptr<OpenMM::System> system;
  OpenMM::CustomIntegrator integrator;
  std::unique_ptr<OpenMM::Context> context;  // last, so that it goes first

  OpenMM::State get(int what) const { return context->getState(what); }
};

OpenMMTwin::OpenMMTwin(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml,
                       double h, double constraint_tolerance, const std::string& platform)
    : impl_(new Impl{{}, OpenMM::CustomIntegrator(h), {}}) {
  const OpenMMFile system_file = open_openmm_file(system_xml, "System");
  const OpenMMFile state_file = open_openmm_file(state_xml, "State");
  impl_->system = read_system(system_file);
  const auto start = read_state(state_file, impl_->system->getNumParticles());

  build_integrator(impl_->integrator);
  impl_->integrator.setConstraintTolerance(constraint_tolerance);
  try {
    impl_->context =
        std::make_unique<OpenMM::Context>(*impl_->system, impl_->integrator, platform_by_name(platform));
  } catch (const OpenMM::OpenMMException& e) {
    system_file.refuse(fmt::format("OpenMM cannot run it: {}", e.what()));
  }
  OpenMM::Vec3 a, b, c;
  start->getPeriodicBoxVectors(a, b, c);
  impl_->context->setPeriodicBoxVectors(a, b, c);
  impl_->context->setTime(start->getTime());
  impl_->context->setPositions(start->getPositions());
  if (start->getDataTypes() & OpenMM::State::Velocities)
    impl_->context->setVelocities(start->getVelocities());
}

OpenMMTwin::~OpenMMTwin() = default;

void OpenMMTwin::set(const State& s) {
  impl_->context->setTime(s.t);
  impl_->context->setPositions(to_openmm(s.x));
  impl_->context->setVelocities(to_openmm(s.v));
}

void OpenMMTwin::step(int n) {
  try {
    impl_->integrator.step(n);
  } catch (const OpenMM::OpenMMException& e) {
    throw SimulationFailure(fmt::format("OpenMM, run beside taut, stopped: {}", e.what()));
  }
}

State OpenMMTwin::state() const {
  using OpenMM::State;
  const State s = impl_->get(State::Positions | State::Velocities | State::Forces);
  return {from_openmm(s.getPositions()), from_openmm(s.getVelocities()), from_openmm(s.getForces()),
          s.getTime()};
}

double OpenMMTwin::potential() const {
  return impl_->get(OpenMM::State::Energy).getPotentialEnergy();
}

double OpenMMTwin::forces_at(const Vectors& x, Vectors& f) {
  impl_->context->setPositions(to_openmm(x));
  const OpenMM::State s = impl_->get(OpenMM::State::Forces | OpenMM::State::Energy);
  f = from_openmm(s.getForces());
  return s.getPotentialEnergy();
}

}  // namespace taut
