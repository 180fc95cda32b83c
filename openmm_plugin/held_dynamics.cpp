#include "openmm_plugin/held_dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "constraints/projection.hpp"
#include "ensembles/langevin.hpp"
#include "md/diagnosis.hpp"
#include "md/observables.hpp"
#include "openmm_plugin/held_system.hpp"

namespace taut {
namespace {

Vectors copy_of(const double* x, int atoms) {
  return Eigen::Map<const Vectors>(x, 3, atoms);
}

// The forces of the engine as those of a step.
class ForcesOfEngine final : public ForceLaw {
 public:
  explicit ForcesOfEngine(Engine& engine) : engine_(engine) {}
  void evaluate(const System&, State& s) override { engine_.forces(s.t, s.x.data(), s.f.data()); }

 private:
  Engine& engine_;
};

// The engine's own update where a barostat would move the box.
class UpdateOfEngine final : public Bath {
 public:
  explicit UpdateOfEngine(Engine& engine) : engine_(engine) {}
  double move_box(const System&, State& s) override {
    engine_.update(s.t, s.x.data(), s.v.data());
    return 0;
  }

 private:
  Engine& engine_;
};

}  // namespace

void check_settings(const HoldSettings& settings) {
  if (!(settings.h > 0) || !std::isfinite(settings.h))
    throw InputError(fmt::format("a step of {} ps, expected more than 0", settings.h));
  if (!(settings.friction >= 0) || !std::isfinite(settings.friction))
    throw InputError(fmt::format("a friction of {} /ps, expected 0 or more", settings.friction));
  if (!(settings.temperature >= 0) || !std::isfinite(settings.temperature))
    throw InputError(fmt::format("a temperature of {} K, expected 0 or more", settings.temperature));
  if (settings.temperature > 0 && settings.friction == 0)
    throw InputError(
        "a temperature without friction has no effect: give both, or neither for constant energy");
  method_of(settings);
}

void set_tolerance(HoldSettings& settings, double tolerance) {
  HoldSettings changed = settings;
  changed.options["tolerance"] = fmt::format("{}", tolerance);
  check_settings(changed);
  settings = changed;
}

double tolerance(const HoldSettings& settings) {
  MethodOptions method = method_of(settings);
  for (const Option& option : method.describe())
    if (option.key == std::string_view("tolerance"))
      if (auto* const* real = std::get_if<double*>(&option.field)) return **real;
  return 1e-5;
}

struct BondProjection::Parts {
  System sys;
  Projector projector;
  explicit Parts(const HeldBonds& held) : sys(system_of(held)), projector(sys) {}
};
BondProjection::BondProjection(const HeldBonds& held) : parts_(std::make_unique<Parts>(held)) {}
BondProjection::~BondProjection() = default;

void BondProjection::positions(double* x) {
  Vectors moved = copy_of(x, parts_->sys.atoms());
  parts_->projector.positions(parts_->sys, moved);
  std::copy_n(moved.data(), moved.size(), x);
}
void BondProjection::velocities(const double* x, double* v) {
  Vectors changed = copy_of(v, parts_->sys.atoms());
  parts_->projector.velocities(parts_->sys, copy_of(x, parts_->sys.atoms()), changed);
  std::copy_n(changed.data(), changed.size(), v);
}

struct HeldDynamics::Parts {
  System sys;
  MethodOptions options;
  double h;
  int threads;
  double friction;
  Langevin langevin;
  DriftVelocity drift;
  VelocityVerlet verlet;
  std::unique_ptr<ConstraintMethod> method;
  State s;
  long steps = 0;

  Parts(const HeldBonds& held, const HoldSettings& settings, int use_threads)
      : sys(system_of(held)),
        options(method_of(settings)),
        h(settings.h),
        threads(use_threads),
        friction(settings.friction),
        langevin(sys, {.temperature = settings.temperature, .friction = friction, .seed = settings.seed}, h),
        drift(sys),
        method(make_method(sys, options, h)) {
    s.x = s.v = s.f = Vectors::Zero(3, sys.atoms());
  }
  Integrator& integrator() {
    if (friction > 0) return langevin;
    return verlet;
  }
};

HeldDynamics::HeldDynamics(const HeldBonds& held, const HoldSettings& settings, int threads)
    : parts_(std::make_unique<Parts>(held, settings, threads)) {}
HeldDynamics::~HeldDynamics() = default;

double* HeldDynamics::x() {
  return parts_->s.x.data();
}
double* HeldDynamics::v() {
  return parts_->s.v.data();
}

void HeldDynamics::start(double t, Engine& engine) {
  Parts& p = *parts_;
  const ThreadScope threads(p.threads);
  p.method = make_method(p.sys, p.options, p.h);
  p.s.t = t;
  ForcesOfEngine forces(engine);
  initialize(p.integrator(), {p.sys, forces, *p.method}, p.h, p.s);
}

void HeldDynamics::step(double t, Engine& engine) {
  Parts& p = *parts_;
  const ThreadScope threads(p.threads);
  p.s.t = t;
  ForcesOfEngine forces(engine);
  UpdateOfEngine update(engine);
  const SolveStats stats = p.integrator().advance({p.sys, forces, *p.method, update}, p.h, p.s);
  ++p.steps;
  if (!stats.held()) throw StepFailure(diagnose(p.sys, p.s, stats, p.steps), stats);
}

double HeldDynamics::kinetic_energy() {
  Parts& p = *parts_;
  const ThreadScope threads(p.threads);
  return taut::kinetic_energy(p.sys, p.drift.of(p.friction > 0 ? p.h : 0, p.s));
}

void HeldDynamics::set_bath(double temperature, double friction) {
  parts_->friction = friction;
  parts_->langevin.set_friction(friction);
  parts_->langevin.set_temperature(temperature);
}

std::string HeldDynamics::save() {
  Parts& p = *parts_;
  std::string kept = std::string(p.options.name()) + '\n', numbers;
  Archive archive = Archive::saving_to(numbers);
  archive(p.s.x, p.s.v, p.s.f, *p.method, p.langevin, p.steps);
  return kept + numbers;
}

void HeldDynamics::load(const std::string& kept) {
  Parts& p = *parts_;
  const std::string_view text = kept, method = text.substr(0, text.find('\n'));
  if (method != p.options.name() || method.size() == text.size())
    throw InputError(
        fmt::format("the checkpoint is of method \"{}\", expected \"{}\"", method, p.options.name()));
  Archive archive = Archive::loading_from(text.substr(method.size() + 1));
  archive(p.s.x, p.s.v, p.s.f, *p.method, p.langevin, p.steps);
  archive.finish();
}

}  // namespace taut
