// What a step costs, and its parts: µs a step, and ns an atom and step. Names read
//     part/scene/precision/threads
// step: whole steps of the scene as it comes, nothing observed; forces: the force field at positions that
// stay; lists: the same, everything moved so far that all lists are made anew; bonds: the method's share of
// the step; kicks: both half kicks and the drift; bonded: springs, angles and torsions alone;
// mesh: what Ewald's sum has beside the pairs, alone (pme scenes: order 4, points 0.116
// nm apart, as GROMACS has it by default); transforms: of these the Fourier transforms of a grid of zeros,
// there and back; wake: a parallel region with nothing to do. openmm: whole steps of
// OpenMM's CPU platform on the same system and threads (its leap-frog Verlet, constraints to 1e-6), where
// taut was built with it. handover: a line of memory 1000 times from one core to another; its
// ns_per_atom_step is one time.
//
// dipeptide is alanine dipeptide in 749 waters as OpenMM's files tests/data/ala2-hbonds-rf have it, bonds
// with hydrogen rigid and the others springs, by newton at 2 fs; it is measured where taut was built with
// OpenMM.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <atomic>
#include <cstdlib>

#include "base/threads.hpp"
#include "constraints/projection.hpp"
#include "forcefield/bonded/bonded_forces.hpp"
#include "forcefield/ewald/fourier.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "forcefield/ewald/pme.hpp"
#include "forcefield/force_field.hpp"
#include "md/diagnosis.hpp"
#include "md/step_parts.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::bench {
namespace {

struct Case {
  std::string name;
  std::string scene;                   // its file
  std::vector<std::string> overrides;  // of its keys
  bool openmm = false;                 // a System and a State of OpenMM's in tests/data, not a scene's file

  Scene read() const {
    if (!openmm) return read_scene(find_scene(scene), overrides);
    const std::string files = TAUT_TEST_DATA "/" + scene;
    Scene imported = import_openmm(files + ".system.xml.gz", files + ".state.xml.gz");
    apply_overrides(imported, overrides);
    return imported;
  }
};

struct Setting {
  Case what;
  Precision precision;
  int threads;

  Scene scene() const {
    Scene scene = what.read();
    scene.terms.precision = precision;
    return scene;
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const int molecules : {216, 1728, 5832, 46656, 110592})
    all.push_back({fmt::format("water{}", molecules),
                   "water",
                   {fmt::format("build.molecules={}", molecules), "method.name=settle"}});
  for (const int side : {6, 12, 18, 36, 48}) {
    const int molecules = side * side * side, grid = 16 * side / 6;  // 0.116 nm apart
    all.push_back(
        {fmt::format("pme{}", molecules),
         "water",
         {fmt::format("build.molecules={}", molecules), "method.name=settle", "forcefield.coulomb=pme",
          "forcefield.pme_order=4", "forcefield.ewald_alpha_per_nm=3.4705",
          fmt::format("forcefield.pme_grid=[{0},{0},{0}]", grid)}});
  }
  all.push_back({"decane", "decane", {"method.name=newton"}});
  all.push_back({"melt", "melt", {"method.name=newton"}});
  all.push_back({"chain", "chain", {"method.name=newton"}});
  all.push_back({"decane5120", "decane", {"method.name=newton", "place.0.count=512"}});  // of so many atoms
  all.push_back({"melt6000", "melt", {"method.name=newton", "build.chains=120"}});
  all.push_back({"chain6000", "chain", {"method.name=newton", "build.chains=300"}});
  all.push_back({"droplet", "water_cluster", {"method.name=settle"}});
  if (built_with_openmm())
    all.push_back({"dipeptide", "ala2-hbonds-rf", {"method.name=newton", "run.dt_fs=2"}, true});
  return all;
}

void count(benchmark::State& bench, long steps, int atoms) {
  using benchmark::Counter;
  bench.SetItemsProcessed(steps);
  bench.counters["ns_per_atom_step"] =
      Counter(1e-9 * double(steps) * atoms, Counter::kIsRate | Counter::kInvert);
}

// A scene set going, past its start.
struct Running {
  Scene scene;
  ForceField forces;
  std::unique_ptr<ConstraintMethod> method;
  VelocityVerlet verlet;
  State state;

  explicit Running(const Setting& setting)
      : scene(setting.scene()),
        forces(scene.system, scene.start.box, scene.terms),
        method(make_method(scene.system, scene.method, scene.run.h())),
        state(scene.start) {
    initialize(verlet, dynamics(), scene.run.h(), state);
    go(20);
  }

  Dynamics dynamics() { return {scene.system, forces, *method}; }

  void go(int steps) {
    for (int n = 0; n < steps; ++n)
      demand_converged(scene.system, state, verlet.advance(dynamics(), scene.run.h(), state), n);
  }
};

constexpr int kStride = 20;  // steps: lists are made every few

void whole_step(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Running run(setting);
  for (auto _ : bench) run.go(kStride);
  count(bench, bench.iterations() * kStride, run.scene.system.atoms());
}

void empty_region(benchmark::State& bench, const Setting& setting) {
  for (auto _ : bench) in_parallel(setting.threads, [](int) {});
}

// From one core to another and back: whether two cores share a cache is what the host decides, from hour to
// hour, and two threads gain more or less with it.
void hand_over(benchmark::State& bench, const Setting& setting) {
  constexpr int kTimes = 500;
  use_threads(setting.threads);
  if (available_threads() < 2) return bench.SkipWithError("built without threads");
  for (auto _ : bench) {
    std::atomic<int> turn{0};
    in_parallel(2, [&](int t) {
      for (int n = 0; n < kTimes; ++n) {
        while (turn.load(std::memory_order_acquire) % 2 != t) continue;
        turn.fetch_add(1, std::memory_order_release);
      }
    });
  }
  count(bench, bench.iterations(), 2 * kTimes);
}

void forces_alone(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Running run(setting);
  for (auto _ : bench) run.forces.evaluate(run.scene.system, run.state);
  count(bench, bench.iterations(), run.scene.system.atoms());
}

void forces_and_lists(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Running run(setting);
  double away = 2;  // [nm], there and back
  for (auto _ : bench) {
    bench.PauseTiming();
    run.state.x.array() += away;
    away = -away;
    bench.ResumeTiming();
    run.forces.evaluate(run.scene.system, run.state);
  }
  count(bench, bench.iterations(), run.scene.system.atoms());
}

void bonds_alone(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Running run(setting);
  for (auto _ : bench) {
    const PartMeter meter(setting.threads, PartMeter::Parts::kBonds);
    run.go(kStride);
    bench.SetIterationTime(meter.seconds_of(StepPart::kBonds));
  }
  count(bench, bench.iterations() * kStride, run.scene.system.atoms());
}

void kicks_and_drift(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Running run(setting);
  for (auto _ : bench) {
    half_kick_and_drift(run.scene.system, 1e-9, nullptr, run.state);
    half_kick(run.scene.system, 1e-9, nullptr, run.state);
    benchmark::DoNotOptimize(run.state.x.data());
  }
  count(bench, bench.iterations(), run.scene.system.atoms());
}

void bonded_alone(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  const Scene scene = setting.scene();
  BondedForces bonded(scene.terms, {});
  Vectors f = Vectors::Zero(3, scene.system.atoms());
  for (auto _ : bench) bonded.add_forces(scene.start.x, f);
  count(bench, bench.iterations(), scene.system.atoms());
}

void mesh_alone(benchmark::State& bench, const Setting& setting) {
  use_threads(setting.threads);
  Scene scene = setting.scene();
  Nonbonded& nb = *scene.terms.nonbonded;
  nb.pme = chosen_parameters(*nb.pme, scene.start.box, *nb.cutoff);
  Pme pme(nb, setting.precision);
  pme.set_box(scene.start.box);
  Vectors f = Vectors::Zero(3, scene.system.atoms());
  for (auto _ : bench) pme.add_forces(scene.start.x, f);
  count(bench, bench.iterations(), scene.system.atoms());
}

void transforms_alone(benchmark::State& bench, const Setting& setting) {
  const Scene scene = setting.scene();
  const Nonbonded& nb = *scene.terms.nonbonded;
  const PmeParameters pme = chosen_parameters(*nb.pme, scene.start.box, *nb.cutoff);
  const auto there_and_back = [&](auto grid) {
    grid.make_room(1);
    for (auto _ : bench) {
      for (int k1 = 0; k1 < pme.grid[0]; ++k1) grid.transform_plane(k1, 0);
      for (int k2 = 0; k2 < grid.half(); ++k2) {
        benchmark::DoNotOptimize(grid.transform_row(k2, 0));
        grid.transform_row_back(k2, 0);
      }
      for (int k1 = 0; k1 < pme.grid[0]; ++k1) grid.transform_plane_back(k1, 0);
    }
  };
  if (setting.precision == Precision::kDouble)
    there_and_back(FourierGrid<double>(pme.grid, pme.order));
  else
    there_and_back(FourierGrid<float>(pme.grid, pme.order));
  count(bench, bench.iterations(), scene.system.atoms());
}

void openmm_step(benchmark::State& bench, const Setting& setting) {
  Scene scene = setting.scene();
  if (auto& nb = scene.terms.nonbonded; nb && nb->pme) nb->pme->order = 5;  // it has no other
  OpenMMInput input{scene.system, scene.terms, scene.start, 0};
  TwinSettings twin_settings;
  twin_settings.h = scene.run.h();
  twin_settings.constraint_tolerance = 1e-6;
  twin_settings.platform = "CPU";
  twin_settings.integrator = TwinIntegrator::kVerlet;
  twin_settings.threads = setting.threads;
  OpenMMTwin twin(input, twin_settings);
  twin.step(kStride);
  for (auto _ : bench) twin.step(kStride);
  count(bench, bench.iterations() * kStride, scene.system.atoms());
}

void add(const std::string& part, void (*function)(benchmark::State&, const Setting&), const Setting& setting,
         const std::string& precision) {
  const std::string name = fmt::format("{}/{}/{}/{}", part, setting.what.name, precision, setting.threads);
  auto* b = benchmark::RegisterBenchmark(name.c_str(), [=](auto& bench) { function(bench, setting); });
  b->Unit(benchmark::kMicrosecond)->MeasureProcessCPUTime();  // at one thread, right on a busy machine too
  part == "bonds" ? b->UseManualTime() : b->UseRealTime();
}

void add_all() {
  for (const Case& what : cases())
    for (const int threads : {1, 2}) {
      for (const auto& [precision, name] :
           {std::pair{Precision::kDouble, "double"}, {Precision::kMixed, "mixed"}}) {
        const Setting setting{what, precision, threads};
        add("step", whole_step, setting, name);
        add("forces", forces_alone, setting, name);
        add("lists", forces_and_lists, setting, name);
        if (what.name.starts_with("pme")) add("mesh", mesh_alone, setting, name);
        if (what.name.starts_with("pme") && threads == 1) add("transforms", transforms_alone, setting, name);
      }
      const Setting setting{what, Precision::kDouble, threads};
      add("bonds", bonds_alone, setting, "double");
      add("kicks", kicks_and_drift, setting, "double");
      const bool bonded = what.scene == "decane" || what.name == "dipeptide";
      if (bonded) add("bonded", bonded_alone, setting, "double");
      if (built_with_openmm()) add("openmm", openmm_step, setting, "single");
    }
  add("handover", hand_over, {{"none", "", {}}, Precision::kDouble, 2}, "double");
  for (const int threads : {2, 4, 8, 16, 32, 64, 128})
    add("wake", empty_region, {{"none", "", {}}, Precision::kDouble, threads}, "double");
}

}  // namespace
}  // namespace taut::bench

int main(int argc, char** argv) {
  taut::bench::add_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
