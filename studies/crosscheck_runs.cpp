#include "studies/crosscheck_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "constraints/bond_graph.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/methods/rattle.hpp"
#include "studies/study_scene.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

constexpr long kDenseSamples = 100;
constexpr double kLongEnough = 5;  // [ps]
constexpr double kBroken = 0.1;    // relative error of a bond that OpenMM has lost

Scene prepared(Scene scene) {
  scene = prepared_for_study(std::move(scene));
  if (scene.run.remove_momentum_every > 0)
    scene.notes.push_back("its momentum is not taken out on the way, in no run");
  scene.run.remove_momentum_every = 0;
  scene.method = exact("").method;
  const Simulation on_bonds(std::move(scene));
  Scene ready = on_bonds.scene();
  ready.start = on_bonds.state();
  return ready;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// Waters: three bonds between three atoms, two of the lengths alike.
std::vector<bool> held_by_settle(const System& sys) {
  std::vector<IndexPair> pairs;
  for (const auto& [i, j, d] : sys.bonds) pairs.push_back({i, j});
  const std::vector<int> cluster = connected_components(sys.atoms(), pairs);
  std::map<int, std::vector<double>> lengths;
  std::map<int, int> atoms;
  for (int a = 0; a < sys.atoms(); ++a) ++atoms[cluster[a]];
  for (const auto& [i, j, d] : sys.bonds) lengths[cluster[i]].push_back(d);
  std::vector<bool> held;
  for (const auto& [i, j, d] : sys.bonds) {
    const std::vector<double>& l = lengths[cluster[i]];
    held.push_back(l.size() == 3 && atoms[cluster[i]] == 3 && (l[0] == l[1] || l[1] == l[2] || l[0] == l[2]));
  }
  return held;
}

// Root mean square relative errors of two kinds of bonds.
std::array<double, 2> rms_of_kinds(const System& sys, const std::vector<bool>& second, const Vectors& x) {
  std::array<double, 2> squares{};
  std::array<int, 2> count{};
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    squares[second[k]] += std::pow((x.col(j) - x.col(i)).norm() / d - 1, 2);
    ++count[second[k]];
  }
  for (int kind : {0, 1}) squares[kind] = std::sqrt(squares[kind] / std::max(1, count[kind]));
  return squares;
}

// Turns moments of a run into samples and averages.
class Recorder {
 public:
  Recorder(const Stage& stage, std::string name, const Against& against)
      : stage_(stage),
        against_(against),
        structure_(stage.scene.system, stage.scene.terms, stage.scene.start.box) {
    followed_.track.name = std::move(name);
  }

  // Throws SimulationFailure where the run has broken.
  void see(long step, const State& s, double potential) {
    const System& sys = stage_.scene.system;
    const std::size_t n = followed_.track.samples.size();
    const auto from = [&](const Frames* frames) {
      return frames && n < frames->size() ? most_apart(s.x, (*frames)[n]) : -1;
    };
    const BondErrors bonds = bond_errors(sys, s.x);
    const auto [by_ccma, by_settle] = rms_of_kinds(sys, stage_.by_settle, s.x);
    const double kinetic = kinetic_energy(sys, s.v);
    if (!s.x.allFinite() || !std::isfinite(potential + kinetic))
      throw SimulationFailure(fmt::format("step {}: positions or energy are no longer numbers", step));
    if (!(bonds.max <= most_off))
      throw SimulationFailure(fmt::format("step {}: a bond is off by {:.1e} of its length", step, bonds.max));
    followed_.track.samples.push_back({.step = step,
                                       .t = static_cast<double>(step) * stage_.scene.run.h(),
                                       .apart = from(against_.openmm),
                                       .from_truth = from(against_.truth),
                                       .energy = potential + kinetic,
                                       .temperature = temperature(kinetic, stage_.dof),
                                       .bond_max = bonds.max,
                                       .bond_rms = bonds.rms,
                                       .settle_rms = by_settle,
                                       .ccma_rms = by_ccma});
    if (keep_frames) followed_.frames.push_back(s.x);
    if (stage_.long_enough() && stage_.uniform(step)) structure_.see(s);
  }

  Followed finish() {
    Track& track = followed_.track;
    std::vector<double> t, energy, kelvin;
    for (const Sample& s : track.samples) {
      if (!stage_.uniform(s.step)) continue;
      t.push_back(s.t);
      energy.push_back(s.energy);
      kelvin.push_back(s.temperature);
    }
    const double per_ns_dof = 1000.0 / std::max(1, stage_.dof);
    track.drift = block_slope(t, energy);
    track.drift.value *= per_ns_dof;
    track.drift.error *= per_ns_dof;
    track.temperature = block_mean(kelvin);
    if (structure_.has_water()) track.oxygens = structure_.oxygen_distances();
    if (structure_.has_chains()) track.end_to_end = structure_.end_to_end();
    return std::move(followed_);
  }

  void fail(const std::string& why) { followed_.track.failure = first_line(why); }
  void share(const Estimate& of_bonds) { followed_.track.constraint_drift = of_bonds; }
  void set(const std::string& setting) { followed_.track.setting = setting; }

  bool keep_frames = false;
  double most_off =
      std::numeric_limits<double>::infinity();  // a bond, relative, in a run that holds its bonds

 private:
  const Stage& stage_;
  Against against_;
  LiquidStructure structure_;
  Followed followed_;
};

}  // namespace

Stage::Stage(const Scene& from, const CrosscheckPlan& the_plan)
    : plan(the_plan),
      scene(prepared(from)),
      dof(Simulation(scene).dof().total()),
      steps(scene.run.steps),
      parting(std::min(steps, plan.parting_steps)),
      every(std::max(1L, steps / plan.samples)),
      dense(std::max(1L, parting / kDenseSamples)),
      by_settle(held_by_settle(scene.system)) {}

bool Stage::samples(long step) const {
  return uniform(step) || step == steps || (step <= parting && step % dense == 0);
}

bool Stage::long_enough() const {
  return static_cast<double>(steps) * scene.run.h() >= kLongEnough;
}

std::unique_ptr<OpenMMTwin> Stage::twin(TwinSettings settings) const {
  settings.h = scene.run.h();
  settings.threads = plan.threads;
  auto twin = plan.files ? std::make_unique<OpenMMTwin>(plan.files->system, plan.files->state, settings)
                         : std::make_unique<OpenMMTwin>(openmm_input(scene), settings);
  twin->set(scene.start);
  return twin;
}

TwinSettings Stage::on_platform(TwinIntegrator integrator) const {
  return {.platform = plan.platform, .integrator = integrator, .precision = plan.precision};
}

TwinSettings Stage::with_plugin(const Contestant& contestant) const {
  TwinSettings settings = on_platform(TwinIntegrator::kTaut);
  const auto* fixed = contestant.method.get_if<MethodOptions>();  // a method of which a study takes no option
  MethodOptions method = fixed != nullptr ? *fixed : contestant.method;
  settings.method = method.name();
  for (const Option& option : method.describe())
    std::visit(
        [&](const auto* field) {
          if constexpr (requires { field->has_value(); }) {
            if (*field) settings.options[option.key] = fmt::format("{}", **field);
          } else {
            settings.options[option.key] = fmt::format("{}", *field);
          }
        },
        option.field);
  return settings;
}

void advance(OpenMMTwin& twin, long steps) {
  if (!ListenScope::now()) return twin.step(static_cast<int>(steps));
  constexpr long kAtOnce = 4;
  for (long left = steps; left > 0; left -= kAtOnce) {
    hear();
    twin.step(static_cast<int>(std::min(left, kAtOnce)));
  }
}

double most_apart(const Vectors& x, const Vectors& y) {
  return std::sqrt((x - y).colwise().squaredNorm().maxCoeff<Eigen::PropagateNaN>());
}

Contestant exact(const std::string& name) {
  return {name, Newton::Options{.tolerance = 1e-12}};
}

Followed follow(const Stage& stage, const Contestant& contestant, long steps, const Against& against,
                int finer, const EachStep& each) {
  Recorder recorder(stage, contestant.name, against);
  recorder.keep_frames = against.truth == nullptr;
  Scene scene = stage.scene;
  scene.method = contestant.method;
  scene.run.dt_fs /= finer;
  scene.run.steps = steps * finer;
  scene.run.log_every = std::max(1L, stage.every * finer);
  try {
    Simulation simulation(std::move(scene));
    recorder.set(simulation.method().setting());
    const auto see = [&](long step) {
      recorder.see(step, simulation.state(), simulation.record().potential);
    };
    see(0);
    const Summary summary = simulation.run({}, [&](long fine_step) {
      if (each) each(simulation.state());
      if (fine_step % finer == 0 && stage.samples(fine_step / finer)) see(fine_step / finer);
    });
    recorder.share(summary.constraint_drift);
  } catch (const SimulationFailure& e) {
    recorder.fail(e.what());
  } catch (const InputError& e) {  // a method that does not take this scene
    recorder.fail(e.what());
  }
  return recorder.finish();
}

Followed follow(const Stage& stage, const std::string& name, OpenMMTwin& twin, long steps,
                const Against& against) {
  Recorder recorder(stage, name, against);
  recorder.keep_frames = against.openmm == nullptr;
  if (!stage.plan.plugged()) recorder.most_off = kBroken;
  const auto see = [&](long step) {
    double potential = 0;
    const State s = twin.state(potential);
    recorder.see(step, s, potential);
  };
  try {
    see(0);
    long last = 0;
    for (long n = 1; n <= steps; ++n) {
      if (!stage.samples(n)) continue;
      advance(twin, n - last);
      last = n;
      see(n);
    }
  } catch (const SimulationFailure& e) {
    recorder.fail(e.what());
  }
  return recorder.finish();
}

std::string run_or_say_why(const std::function<void()>& run) {
  try {
    run();
  } catch (const SimulationFailure& e) {
    return first_line(e.what());
  } catch (const InputError& e) {
    return first_line(e.what());
  }
  return "";
}

namespace {

constexpr double kTolerance = 1e-6;

// Microseconds a step of `advance(steps)`, over about `seconds`.
double time_steps(double seconds, const std::function<void(long)>& advance) {
  using Clock = std::chrono::steady_clock;
  const auto time = [&](long steps) {
    const auto start = Clock::now();
    advance(steps);
    return std::chrono::duration<double>(Clock::now() - start).count() / static_cast<double>(steps);
  };
  time(10);  // lists, pages, clocks
  const double guess = time(20);
  return 1e6 * time(std::clamp(static_cast<long>(seconds / guess), 20L, 1000000L));
}

double time_taut(const Stage& stage, const MethodOptions& method) {
  Scene scene = stage.scene;
  scene.method = method;
  return time_steps(stage.plan.speed_seconds, [&](long steps) {
    scene.run.steps = scene.run.log_every = steps;
    Simulation simulation(scene);
    simulation.run({});
    scene.start = simulation.state();
  });
}

double time_twin(const Stage& stage, const TwinSettings& settings) {
  const auto twin = stage.twin(settings);
  const double us = time_steps(stage.plan.speed_seconds, [&](long steps) { advance(*twin, steps); });
  if (!twin->state().x.allFinite())
    throw SimulationFailure("OpenMM, run beside taut: positions are no longer numbers");
  return us;
}

}  // namespace

std::vector<Speed> measure_speed(const Stage& stage) {
  std::vector<Speed> speed;
  if (!(stage.plan.speed_seconds > 0)) return speed;
  const auto add = [&](const std::string& who, const auto& time) {
    Speed& of = speed.emplace_back(Speed{who});
    of.failure = run_or_say_why([&] { of.us_per_step = time(); });
  };
  const auto add_taut = [&](const std::string& name, const MethodOptions& method) {
    add("taut, " + name, [&] { return time_taut(stage, method); });
  };
  const auto add_twin = [&](const std::string& name, const TwinSettings& settings) {
    add(name, [&] { return time_twin(stage, settings); });
  };
  if (stage.plan.plugged()) {
    for (const Contestant& contestant : stage.plan.contestants) {
      add_taut(contestant.name, contestant.method);
      add_twin(fmt::format("OpenMM {}, TautIntegrator {}", stage.plan.platform, contestant.name),
               stage.with_plugin(contestant));
    }
    return speed;
  }
  for (const auto& [name, method] : std::initializer_list<std::pair<const char*, MethodOptions>>{
           {"rattle at 1e-6", Rattle::Options{{.tolerance = kTolerance}}},
           {"newton at 1e-6", Newton::Options{.tolerance = kTolerance}},
           {"feedforward", Feedforward::Options{}},
           {"baumgarte", Baumgarte::Options{}}})
    add_taut(name, method);
  for (const auto& [name, integrator] :
       {std::pair("OpenMM CPU, VerletIntegrator at 1e-6", TwinIntegrator::kVerlet),
        {"OpenMM CPU, RATTLE CustomIntegrator at 1e-6", TwinIntegrator::kRattle}})
    add_twin(name, {.constraint_tolerance = kTolerance, .platform = "CPU", .integrator = integrator});
  return speed;
}

}  // namespace taut
