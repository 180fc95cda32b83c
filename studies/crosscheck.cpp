#include "studies/crosscheck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/exceeds.hpp"
#include "base/nearest_name.hpp"
#include "base/threads.hpp"
#include "studies/crosscheck_causes.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

constexpr int kFiner = 8;
constexpr double kTight = 1e-12;
constexpr std::array kUsualTolerances = {1e-5, 1e-8};  // of OpenMM's integrators: the first is their default

// Holds the bonds so tight that what is left of a difference from OpenMM is not the method's.
void tighten(MethodOptions& method) {
  for (const Option& option : method.describe())
    if (option.key == std::string_view("tolerance")) *std::get<double*>(option.field) = kTight;
}

// The rms of what rounding lengths to float leaves of them.
double float_rounding(const System& sys) {
  double sum = 0;
  for (const auto& [i, j, d] : sys.bonds)
    sum += std::pow(static_cast<double>(static_cast<float>(d)) / d - 1, 2);
  return sys.bonds.empty() ? 0.0 : std::sqrt(sum / sys.bond_count());
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
  for (const double tolerance : kUsualTolerances) {
    const std::string name = fmt::format("openmm verlet {:g}", tolerance);
    now(fmt::format("OpenMM, VerletIntegrator at {:g}", tolerance));
    TwinSettings settings = stage.on_platform(TwinIntegrator::kVerlet);
    settings.constraint_tolerance = tolerance;
    c.openmm_own.push_back(follow(stage, name, *stage.twin(settings), stage.steps, against).track);
  }
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
  if (!plugged()) return {"newton", "rattle", "feedforward", "baumgarte"};
  if (platform == "Reference" || platform == "CPU") return {"feedforward", "baumgarte", "newton"};
  return {"feedforward", "baumgarte"};  // which devices have
}

std::vector<Contestant> contestants(const std::vector<std::string>& words, bool for_plugin) {
  std::vector<Contestant> all;
  for (const std::string& word : words) {
    Contestant& one = all.emplace_back(Contestant{word, method_in_word(word)});
    // Those two correct the bonds by a law over several steps, whose residual is left at any tolerance.
    const bool projects = one.method.name() != "feedforward" && one.method.name() != "baumgarte";
    if ((projects || for_plugin) && word.find("tolerance=") == word.npos) tighten(one.method);
  }
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
               .every = stage.every,
               .dense = stage.dense,
               .settled = static_cast<int>(std::ranges::count(stage.by_settle, true)),
               .float_rounding = float_rounding(stage.scene.system),
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
