#include "studies/crosscheck.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/exceeds.hpp"
#include "base/nearest_name.hpp"
#include "base/threads.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "studies/crosscheck_causes.hpp"

namespace taut {
namespace {

constexpr int kFiner = 8;
constexpr double kTight = 1e-12;
constexpr std::array kGains = {"reversible", "dead-beat", "rattle", "critical", "physical", "box2d"};

// The projections, held so tight that what is left is not theirs.
void tighten(MethodOptions& method) {
  for (const Option& option : method.describe())
    if (option.key == std::string_view("tolerance")) *std::get<double*>(option.field) = kTight;
}

std::vector<Contestant> named(const std::string& name, bool for_plugin) {
  const auto colon = name.find(':');
  const std::string method = name.substr(0, colon);
  std::vector<Contestant> found;
  if (method != "baumgarte") {
    if (colon != name.npos)
      throw InputError(fmt::format("--method {}: only baumgarte has gains to name", name));
    found.push_back({name, default_options(name)});
    if (for_plugin || name != "feedforward") tighten(found.back().method);
    return found;
  }
  for (const std::string gains : kGains)
    if (colon == name.npos || gains == name.substr(colon + 1))
      found.push_back({"baumgarte " + gains, Baumgarte::Options{.gains = gains}});
  if (for_plugin)
    for (Contestant& each : found) tighten(each.method);
  if (found.empty())
    throw InputError(
        fmt::format("--method {}: expected one of baumgarte:{}", name, fmt::join(kGains, ", baumgarte:")));
  return found;
}

// The plug-in's runs, each against taut's own of the same method.
void hold_plugin(const Stage& stage, Crosscheck& c, const Tell& now) {
  for (const Contestant& contestant : stage.plan.contestants) {
    now(contestant.name);
    Followed ours = follow(stage, contestant, stage.steps, {});
    if (c.plugged.empty()) {
      now(contestant.name + ", moved by 1e-10 nm");
      c.nudged = nudged_run(stage, contestant, {.openmm = &ours.frames});
      c.chaos = chaos_of(c.nudged);
    }
    now("OpenMM, TautIntegrator " + contestant.name);
    const auto twin = stage.twin(stage.with_plugin(contestant));
    Track theirs =
        follow(stage, "openmm " + contestant.name, *twin, stage.steps, {.openmm = &ours.frames}).track;
    c.plugged.push_back({std::move(ours.track), std::move(theirs)});
  }
}

// OpenMM's own integrators, and against them taut's methods.
void hold_methods(const Stage& stage, OpenMMTwin& twin, Crosscheck& c, const Tell& now) {
  now(fmt::format("newton at h/{}, the third opinion", kFiner));
  Followed fine = follow(stage, exact(fmt::format("newton at h/{}", kFiner)), stage.parting, {}, kFiner);
  now("OpenMM, RATTLE CustomIntegrator");
  Followed openmm = follow(stage, "openmm rattle", twin, stage.steps, {.truth = &fine.frames});
  const Against against{.openmm = &openmm.frames, .truth = &fine.frames};

  now("OpenMM, VerletIntegrator");
  const auto verlet = stage.twin(stage.on_platform(TwinIntegrator::kVerlet));
  c.verlet = follow(stage, "openmm verlet", *verlet, stage.parting, against).track;
  now("OpenMM, moved by 1e-10 nm");
  c.nudged = nudged_run(stage, against);
  c.chaos = chaos_of(c.nudged);
  for (const Contestant& contestant : stage.plan.contestants) {
    now(contestant.name);
    c.tracks.push_back(follow(stage, contestant, stage.steps, against).track);
  }
  c.fine = std::move(fine.track);
  c.twin = std::move(openmm.track);
  if (c.twin.failed()) return;
  now("why they part");
  c.openmm_bonds.worst = c.twin.worst_bond();
  c.openmm_bonds.failure =
      run_or_say_why([&] { c.openmm_bonds = openmm_bonds(stage, c.openmm_bonds.worst); });
  c.leapfrog.failure = run_or_say_why([&] { c.leapfrog = compare_leapfrog(stage); });
}

}  // namespace

std::vector<std::string> CrosscheckPlan::usual_methods() const {
  if (!plugged()) return {"newton", "rattle", "feedforward", "baumgarte", "none"};
  if (platform == "Reference" || platform == "CPU") return {"feedforward", "baumgarte:reversible", "newton"};
  return {"feedforward", "baumgarte:reversible"};  // which devices have
}

std::vector<Contestant> contestants(const std::vector<std::string>& names, bool for_plugin) {
  std::vector<Contestant> all;
  for (const auto& name : names)
    for (auto& contestant : named(name, for_plugin)) all.push_back(std::move(contestant));
  return all;
}

double Track::most_apart() const {
  double most = -1;
  for (const Sample& s : samples)
    if (exceeds(s.apart, most)) most = s.apart;
  return most;
}

double Track::apart_at(long step) const {
  double apart = -1;
  for (const Sample& s : samples)
    if (s.step <= step && s.apart >= 0) apart = s.apart;
  return apart;
}

std::optional<long> Track::parted_at(double nm) const {
  for (const Sample& s : samples)
    if (s.apart > nm) return s.step;
  return {};
}

double Track::worst_bond() const {
  double worst = 0;
  for (const Sample& s : samples)
    if (exceeds(s.bond_max, worst)) worst = s.bond_max;
  return worst;
}

double Track::rms_bond(long step) const {
  double squares = 0;
  int count = 0;
  for (const Sample& s : samples) {
    if (s.step == 0 || s.step > step) continue;
    squares += s.bond_rms * s.bond_rms;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

Crosscheck crosscheck(const Scene& scene, const CrosscheckPlan& plan, const Tell& tell) {
  const auto now = [&](const std::string& what) {
    if (tell) tell(what);
  };
  expect_name("--integrator", plan.integrator, {"openmm", "taut"});
  const ThreadScope equal_threads(plan.threads);
  const Stage stage(scene, plan);
  std::unique_ptr<OpenMMTwin> twin;  // all is refused here, before anything is run
  if (plan.plugged())
    for (const Contestant& contestant : plan.contestants) twin = stage.twin(stage.with_plugin(contestant));
  if (!twin) twin = stage.twin(stage.on_platform());

  Crosscheck c{.scene = scene.name,
               .openmm = openmm_version(),
               .platform = plan.platform,
               .precision = plan.precision,
               .in_double = plan.in_double(),
               .extent = stage.scene.start.x.cwiseAbs().maxCoeff(),
               .notes = stage.scene.notes,
               .atoms = stage.scene.system.atoms(),
               .bonds = stage.scene.system.bond_count(),
               .dof = stage.dof,
               .h = stage.scene.run.h(),
               .steps = stage.steps,
               .parting = stage.parting,
               .agreement = plan.agreement};
  c.long_enough = stage.long_enough();
  c.start = compare_start(stage, *twin);
  twin->set(stage.scene.start);
  if (plan.plugged())
    hold_plugin(stage, c, now);
  else
    hold_methods(stage, *twin, c, now);
  now("speed");
  c.speed = measure_speed(stage);
  return c;
}

}  // namespace taut
