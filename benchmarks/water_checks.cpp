// One run of rigid molecules, as statistics sees it:
//     water_checks SCENE PICOSECONDS DT_FS METHOD [KEY=VALUE ...]
// One row: temperatures of translation and rotation, χ² of the molecules' kinetic energies against the
// canonical law at run.temperature_k (nine degrees of freedom; without a thermostat it says nothing),
// pressure, drift of the total energy in % of the kinetic energy per 100 ps, bond error; a ± b: standard
// error from blocks. `header` in place of SCENE prints the columns' names.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/statistics.hpp"
#include "ensembles/pressure.hpp"
#include "md/units.hpp"
#include "simulation/simulation.hpp"
#include "simulation/temperatures.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

constexpr int kBins = 10, kAtoms = 3;

// Kinetic energies of molecules with six degrees of freedom, in bins as likely: in units of kT they have
// P(x) = ½x²e⁻ˣ.
class Histogram {
 public:
  explicit Histogram(double temperature) : kT_(kBoltzmann * temperature) {}

  void see(const System& sys, const Vectors& v) {
    for (int first = 0; first < sys.atoms(); first += kAtoms) {
      double x = 0;
      for (int a = first; a < first + kAtoms; ++a) x += 0.5 * sys.mass[a] * v.col(a).squaredNorm() / kT_;
      const double below = 1 - std::exp(-x) * (1 + x + x * x / 2);
      ++counts_[std::min(kBins - 1, static_cast<int>(kBins * below))];
      ++count_;
    }
  }

  double chi_square() const {
    double sum = 0;
    for (const double n : counts_) sum += std::pow(n - count_ / kBins, 2) / (count_ / kBins);
    return sum;
  }
  double samples() const { return count_; }

 private:
  double kT_, count_ = 0;
  std::array<double, kBins> counts_{};
};

struct Plan {
  std::string scene, method;
  double picoseconds, dt_fs;
  std::vector<std::string> keys;
};

constexpr double kEvery = 0.5;         // ps between samples
constexpr double kEquilibration = 10;  // ps before the first

Scene scene_of(const Plan& plan) {
  const long every = std::lround(kEvery * 1000 / plan.dt_fs);
  std::vector<std::string> keys = plan.keys;
  keys.insert(keys.end(), {fmt::format("run.dt_fs={}", plan.dt_fs), "method.name=" + plan.method,
                           fmt::format("run.steps={}", std::lround(plan.picoseconds * 1000 / plan.dt_fs)),
                           fmt::format("run.log_every={}", every)});
  return read_scene(find_scene(plan.scene), keys);
}

std::string row(const Plan& plan) {
  Simulation simulation(scene_of(plan));
  const Scene& scene = simulation.scene();
  const System& sys = scene.system;
  Temperatures temperatures(sys, scene.terms, simulation.state().x, true,
                            {RigidMotions::Which::kTranslations, sys, simulation.state().x});
  Histogram histogram(scene.run.temperature_k);
  Barometer barometer(sys);
  ForceField forces(sys, scene.start.box, scene.terms);
  RunningMean pressure;
  std::vector<double> t, energy;
  double kinetic = 0;
  const Summary summary = simulation.run([&](const Record& r) {
    t.push_back(r.t);
    energy.push_back(r.total());
    kinetic += r.kinetic;
    if (r.t < kEquilibration) return;
    const Vectors v = simulation.thermal_velocity();
    temperatures.see(sys, simulation.state().x, v);
    histogram.see(sys, v);
    pressure.add(barometer(sys, forces, simulation.state(), v, {}).trace() / 3);
  });
  const double percent = 100 * 100 / (kinetic / static_cast<double>(t.size()));  // per 100 ps
  const Estimate drift = block_slope(t, energy), translation = temperatures.of_all(MotionClass::kTranslation),
                 rotation = temperatures.of_all(MotionClass::kRotation), p = pressure.estimate();
  return fmt::format(
      "{},{},{},\"{}\",{},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f},{:.0f},{:.0f},{:.0f},{:.4f},{:.4f},{:.1e}",
      plan.scene, plan.method, plan.dt_fs, fmt::join(plan.keys, " "), plan.picoseconds, translation.value,
      translation.error, rotation.value, rotation.error, histogram.chi_square(), histogram.samples(), p.value,
      p.error, percent * drift.value, percent * drift.error, summary.rms_rel_bond_error);
}

}  // namespace
}  // namespace taut

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "header") {
    fmt::print(
        "scene,method,dt_fs,keys,ps,translation_k,translation_error,rotation_k,rotation_error,chi_square,"
        "samples,"
        "pressure_bar,pressure_error,drift_percent_per_100ps,drift_error,rms_rel_bond_error\n");
    return 0;
  }
  if (argc < 5) {
    fmt::print(stderr, "water_checks SCENE PICOSECONDS DT_FS METHOD [KEY=VALUE ...], or header\n");
    return 2;
  }
  try {
    fmt::print("{}\n", taut::row({argv[1], argv[4], std::stod(argv[2]), std::stod(argv[3]),
                                  std::vector<std::string>(argv + 5, argv + argc)}));
  } catch (const std::exception& e) {
    fmt::print(stderr, "water_checks: {}\n", e.what());
    return 1;
  }
}
