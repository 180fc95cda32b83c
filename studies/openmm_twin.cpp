#include "studies/openmm_twin.hpp"

#include <OpenMM.h>
#include <fmt/format.h>
#include <openmm/serialization/XmlSerializer.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "base/errors.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "studies/openmm_plugins.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {
namespace {

Vectors from_openmm(const std::vector<OpenMM::Vec3>& columns) {
  Vectors to(3, columns.size());
  for (Eigen::Index a = 0; a < to.cols(); ++a) to.col(a) << columns[a][0], columns[a][1], columns[a][2];
  return to;
}

std::vector<OpenMM::Vec3> to_openmm(const Vectors& columns) {
  std::vector<OpenMM::Vec3> to;
  to.reserve(columns.cols());
  for (const auto& c : columns.colwise()) to.emplace_back(c.x(), c.y(), c.z());
  return to;
}

// OpenMM places virtual sites at the end of its integrator's steps. With sites a step is two of these, so
// that they are placed where the force at its end is taken.
void build_integrator(OpenMM::CustomIntegrator& twin, bool in_halves) {
  twin.addPerDofVariable("x1", 0);
  if (in_halves) {
    twin.addGlobalVariable("first", 0);
    twin.addComputeGlobal("first", "1 - first");
    twin.beginIfBlock("first = 1");
  }
  twin.addComputePerDof("v", "v + 0.5*dt*f/m");
  twin.addComputePerDof("x", "x + dt*v");
  twin.addComputePerDof("x1", "x");
  twin.addConstrainPositions();
  if (in_halves) {
    twin.endBlock();
    twin.beginIfBlock("first = 0");
  }
  twin.addComputePerDof("v", "v + 0.5*dt*f/m + (x - x1)/dt");
  twin.addConstrainVelocities();
  if (in_halves) twin.endBlock();
}

bool has_sites(const OpenMM::System& system) {
  for (int a = 0; a < system.getNumParticles(); ++a)
    if (system.isVirtualSite(a)) return true;
  return false;
}

void set_box(OpenMM::Context& context, const Box& box) {
  if (!box.periodic()) return;
  const Eigen::Matrix3d m = box.vectors();
  const auto column = [&](int d) { return OpenMM::Vec3(m(0, d), m(1, d), m(2, d)); };
  context.setPeriodicBoxVectors(column(0), column(1), column(2));
}

Box box_of(const OpenMM::State& state) {
  OpenMM::Vec3 a, b, c;
  state.getPeriodicBoxVectors(a, b, c);
  return {{a[0], b[1], c[2]}, {b[0], c[0], c[1]}};
}

// Removed where the caller asks for momentum to be left alone: VerletIntegrator would heed it.
void drop_momentum_removers(OpenMM::System& system) {
  for (int k = system.getNumForces() - 1; k >= 0; --k)
    if (dynamic_cast<const OpenMM::CMMotionRemover*>(&system.getForce(k)) != nullptr) system.removeForce(k);
}

// PME's parameters said, where OpenMM would choose the grid, each of its platforms another.
void say_pme_parameters(OpenMM::System& system, const OpenMM::State& start) {
  for (int k = 0; k < system.getNumForces(); ++k) {
    auto* force = dynamic_cast<OpenMM::NonbondedForce*>(&system.getForce(k));
    if (!force || force->getNonbondedMethod() != OpenMM::NonbondedForce::PME) continue;
    double alpha;
    std::array<int, 3> grid;
    force->getPMEParameters(alpha, grid[0], grid[1], grid[2]);
    if (alpha != 0) continue;
    PmeParameters chosen;
    chosen.tolerance = force->getEwaldErrorTolerance();
    chosen = chosen_parameters(chosen, box_of(start), force->getCutoffDistance());
    force->setPMEParameters(chosen.alpha, chosen.grid[0], chosen.grid[1], chosen.grid[2]);
  }
}

std::string on_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

template <class T>
std::unique_ptr<T> deserialize(const std::string& xml) {
  std::istringstream stream(xml);
  return std::unique_ptr<T>(OpenMM::XmlSerializer::deserialize<T>(stream));
}

// TautIntegrator, whose class the plug-in alone has.
std::unique_ptr<OpenMM::Integrator> make_plugged(const TwinSettings& settings) {
  load_taut_plugin(settings.platform);
  std::string options;
  for (const auto& [name, value] : settings.options) options += fmt::format(" {}=\"{}\"", name, value);
  try {
    return deserialize<OpenMM::Integrator>(fmt::format(
        "<Integrator type=\"TautIntegrator\" version=\"1\" stepSize=\"{}\" method=\"{}\"><Options{}/>"
        "</Integrator>",
        settings.h, settings.method, options));
  } catch (const OpenMM::OpenMMException& wrong) {
    throw InputError(fmt::format("--integrator taut: OpenMM {}: {}", openmm_version(), wrong.what()));
  }
}

std::unique_ptr<OpenMM::Integrator> make_integrator(const TwinSettings& settings, bool in_halves) {
  if (settings.integrator == TwinIntegrator::kTaut) return make_plugged(settings);
  std::unique_ptr<OpenMM::Integrator> integrator;
  if (settings.integrator == TwinIntegrator::kVerlet) {
    integrator = std::make_unique<OpenMM::VerletIntegrator>(settings.h);
  } else {
    auto twin = std::make_unique<OpenMM::CustomIntegrator>(settings.h);
    build_integrator(*twin, in_halves);
    integrator = std::move(twin);
  }
  integrator->setConstraintTolerance(settings.constraint_tolerance);
  return integrator;
}

// By OpenMM's own reader, which takes a truncated file for a shorter one and recurses: XmlFile looked first.
template <class T>
std::unique_ptr<T> deserialize(const XmlFile& file) {
  try {
    return deserialize<T>(file.text());
  } catch (const std::exception& e) {
    const Element root = file.root();
    file.refuse(fmt::format("OpenMM {} cannot read it (written by OpenMM {}): {}", openmm_version(),
                            root.has_attribute("openmmVersion") ? root.text("openmmVersion") : "?",
                            on_one_line(e.what())));
  }
}

std::map<std::string, std::string> properties_of(const OpenMM::Platform& platform,
                                                 const TwinSettings& settings) {
  const auto& names = platform.getPropertyNames();
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::map<std::string, std::string> properties;
  if (settings.threads > 0 && has("Threads")) properties["Threads"] = std::to_string(settings.threads);
  if (settings.precision.empty()) return properties;
  if (!has("Precision"))
    throw InputError(fmt::format(
        "--precision {}: OpenMM's platform {} leaves no choice of it: leave it out, or take --platform "
        "OpenCL, CUDA or HIP",
        settings.precision, settings.platform));
  properties["Precision"] = settings.precision;
  return properties;
}

// As Context::setState, but for what belongs to the State's integrator, which is another.
void set_state(OpenMM::Context& context, const OpenMM::State& from) {
  set_box(context, box_of(from));
  context.setTime(from.getTime());
  context.setPositions(from.getPositions());
  context.computeVirtualSites();
  if (from.getDataTypes() & OpenMM::State::Velocities) context.setVelocities(from.getVelocities());
  if (from.getDataTypes() & OpenMM::State::Parameters)
    for (const auto& [name, value] : from.getParameters()) context.setParameter(name, value);
}

// What OpenMM throws in a run is the run's failure.
template <class Act>
auto in_a_run(const Act& act) {
  try {
    return act();
  } catch (const OpenMM::OpenMMException& e) {
    throw SimulationFailure(fmt::format("OpenMM, run beside taut, stopped: {}", on_one_line(e.what())));
  }
}

}  // namespace

bool built_with_openmm() {
  return true;
}

struct OpenMMTwin::Impl {
  TwinSettings settings;
  std::unique_ptr<OpenMM::System> system;
  std::unique_ptr<OpenMM::Integrator> integrator;
  std::unique_ptr<OpenMM::Context> context;  // last, so that it goes first

  OpenMM::State get(int what) const { return context->getState(what); }
  Vectors velocities() const { return from_openmm(get(OpenMM::State::Velocities).getVelocities()); }
  bool periodic() const { return system->usesPeriodicBoundaryConditions(); }
  bool in_halves() const { return settings.integrator == TwinIntegrator::kRattle && has_sites(*system); }
  bool lags() const { return settings.integrator == TwinIntegrator::kVerlet; }

  // OpenMM leaves at a site what it has handed to the parents.
  Vectors forces(const OpenMM::State& of) const {
    Vectors f = from_openmm(of.getForces());
    for (int a = 0; a < f.cols(); ++a)
      if (system->isVirtualSite(a)) f.col(a).setZero();
    return f;
  }

  void place(const Vectors& x) const {
    context->setPositions(to_openmm(x));
    context->computeVirtualSites();
  }

  // v + share·hf/m
  Vectors kicked(Vectors v, double share, const Vectors& f) const {
    for (int a = 0; a < v.cols(); ++a)
      if (const double mass = system->getParticleMass(a); mass > 0)
        v.col(a) += share * settings.h / mass * f.col(a);
    return v;
  }

  // P(v_{n−½} + ½hf_n/m)
  Vectors full_step_velocities(const Vectors& f) const {
    const Vectors kept = velocities();
    context->setVelocities(to_openmm(kicked(kept, 0.5, f)));
    context->applyVelocityConstraints(settings.constraint_tolerance);
    Vectors v = velocities();
    context->setVelocities(to_openmm(kept));
    return v;
  }
};

void OpenMMTwin::start(std::unique_ptr<OpenMM::System> system, const TwinSettings& settings) {
  drop_momentum_removers(*system);
  OpenMM::Platform& platform = platform_by_name(settings.platform);
  const std::map<std::string, std::string> properties = properties_of(platform, settings);
  impl_.reset(new Impl{settings, std::move(system), {}, {}});
  impl_->integrator = make_integrator(settings, impl_->in_halves());
  try {
    impl_->context =
        std::make_unique<OpenMM::Context>(*impl_->system, *impl_->integrator, platform, properties);
  } catch (const OpenMM::OpenMMException& e) {
    throw InputError(fmt::format("OpenMM cannot run it: {}", on_one_line(e.what())));
  }
}

OpenMMTwin::OpenMMTwin(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml,
                       const TwinSettings& settings) {
  const XmlFile system_file(system_xml, "System"), state_file(state_xml, "State");
  auto system = deserialize<OpenMM::System>(system_file);
  const auto from = deserialize<OpenMM::State>(state_file);
  try {
    say_pme_parameters(*system, *from);
    start(std::move(system), settings);
  } catch (const InputError& e) {
    system_file.refuse(e.what());
  }
  try {
    set_state(*impl_->context, *from);
  } catch (const OpenMM::OpenMMException& e) {
    state_file.refuse(fmt::format("OpenMM cannot start from it: {}", on_one_line(e.what())));
  }
}

OpenMMTwin::OpenMMTwin(const OpenMMInput& input, const TwinSettings& settings) {
  start(deserialize<OpenMM::System>(openmm_system_xml(input)), settings);
  set(input.start);
}

OpenMMTwin::~OpenMMTwin() = default;

void OpenMMTwin::set(const State& s) {
  set_box(*impl_->context, s.box);
  impl_->context->setTime(s.t);
  impl_->place(s.x);
  const bool lags = impl_->lags();
  const Vectors f = lags ? impl_->forces(impl_->get(OpenMM::State::Forces)) : Vectors();
  impl_->context->setVelocities(to_openmm(lags ? impl_->kicked(s.v, -0.5, f) : s.v));
}

void OpenMMTwin::step(int n) {
  in_a_run([&] {
    const double t = impl_->get(0).getTime();
    impl_->integrator->step(impl_->in_halves() ? 2 * n : n);
    if (impl_->in_halves()) impl_->context->setTime(t + n * impl_->settings.h);
  });
}

State OpenMMTwin::state() const {
  double potential = 0;
  return state(potential);
}

State OpenMMTwin::state(double& potential) const {
  using What = OpenMM::State;
  return in_a_run([&]() -> State {
    const What s = impl_->get(What::Positions | What::Forces | What::Energy);
    potential = s.getPotentialEnergy();
    const Vectors f = impl_->forces(s);
    return {from_openmm(s.getPositions()),
            impl_->lags() ? impl_->full_step_velocities(f) : impl_->velocities(), f, s.getTime(),
            impl_->periodic() ? box_of(s) : Box{}};
  });
}

Vectors OpenMMTwin::kept_velocities() const {
  return impl_->velocities();
}

double OpenMMTwin::potential() const {
  return impl_->get(OpenMM::State::Energy).getPotentialEnergy();
}

double OpenMMTwin::forces_at(const Vectors& x, Vectors& f) {
  impl_->place(x);
  const OpenMM::State s = impl_->get(OpenMM::State::Forces | OpenMM::State::Energy);
  f = impl_->forces(s);
  return s.getPotentialEnergy();
}

std::string openmm_version() {
  return OpenMM::Platform::getOpenMMVersion();
}

}  // namespace taut
