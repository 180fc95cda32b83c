// The gains question: energy drift and residual over the (αh, (βh)²) plane, for one scene at one step.
//     gains_plane SCENE STEPS [DT_FS ...] > plane.csv
// One row a point, RATTLE (newton, 1e-12) and feedforward at the end; drift in kJ/mol/ns/degree of freedom.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "constraints/propagator.hpp"
#include "md/errors.hpp"
#include "systems/scene_file.hpp"
#include "systems/simulation.hpp"

namespace {

using namespace taut;

void run_point(const std::string& scene_name, double dt_fs, long steps, const MethodOptions& options,
               const std::string& point) {
  Scene scene = read_scene(find_scene(scene_name));
  scene.run.dt_fs = dt_fs;
  scene.run.steps = steps;
  scene.run.log_every = 5;
  scene.method = options;
  long survived = 0;
  fmt::print("{},{:g},{}", scene.name, dt_fs, point);
  try {
    Simulation simulation(std::move(scene));
    const Summary s = simulation.run({}, [&](long step) { survived = step; });
    fmt::print(",{},{:.4e},{:.1e},{:.3e},{:.3e}\n", survived, s.drift, s.drift_error, s.rms_rel_bond_error,
               s.max_rel_bond_error);
  } catch (const SimulationFailure&) {
    fmt::print(",{},nan,nan,nan,nan\n", survived);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: gains_plane SCENE STEPS DT_FS [DT_FS ...]\n");
    return 2;
  }
  const std::string scene = argv[1];
  const long steps = std::atol(argv[2]);
  fmt::print("scene,dt_fs,method,damping,alpha_h,beta_h_squared,steps_survived,drift,drift_error,rms,max\n");
  for (int a = 3; a < argc; ++a) {
    const double dt_fs = std::atof(argv[a]), h = dt_fs * 1e-3;
    for (const Damping damping : {Damping::kCentred, Damping::kImplicit})
      for (const double ah : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0})
        for (const double b2 : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0})
          run_point(scene, dt_fs, steps,
                    Baumgarte::Options{.gains = "numbers",
                                       .damping = std::string(name_of(damping)),
                                       .alpha_per_ps = ah / h,
                                       .beta_per_ps = std::sqrt(b2) / h},
                    fmt::format("baumgarte,{},{:g},{:g}", name_of(damping), ah, b2));
    run_point(scene, dt_fs, steps, Newton::Options{.tolerance = 1e-12}, "newton,,,");
    run_point(scene, dt_fs, steps, Feedforward::Options{}, "feedforward,,,");
  }
}
