// Whole steps per second, taut's and OpenMM's, on equal threads.

#include <algorithm>
#include <chrono>

#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/feedforward.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/methods/rattle.hpp"
#include "studies/crosscheck_causes.hpp"

namespace taut {
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

}  // namespace

std::vector<Speed> measure_speed(const Stage& stage) {
  std::vector<Speed> speed;
  if (!(stage.plan.speed_seconds > 0)) return speed;
  for (const auto& [name, method] : std::initializer_list<std::pair<const char*, MethodOptions>>{
           {"taut, rattle at 1e-6", Rattle::Options{{.tolerance = kTolerance}}},
           {"taut, newton at 1e-6", Newton::Options{.tolerance = kTolerance}},
           {"taut, feedforward", Feedforward::Options{}},
           {"taut, baumgarte reversible", Baumgarte::Options{}}})
    speed.push_back({name, time_taut(stage, method)});
  for (const auto& [name, integrator] :
       {std::pair("OpenMM CPU, VerletIntegrator at 1e-6", TwinIntegrator::kVerlet),
        {"OpenMM CPU, RATTLE CustomIntegrator at 1e-6", TwinIntegrator::kRattle}}) {
    const auto twin =
        stage.twin({.constraint_tolerance = kTolerance, .platform = "CPU", .integrator = integrator});
    speed.push_back({name, time_steps(stage.plan.speed_seconds,
                                      [&](long steps) { twin->step(static_cast<int>(steps)); })});
  }
  return speed;
}

}  // namespace taut
