// What OpenMM pays for rigid bonds: whole steps with them less whole steps without, of the same molecules,
// nothing else acting, ns per bond (per molecule for water) and step. The integrator is the twin of our
// RATTLE, which constrains positions and velocities (studies/openmm_twin.hpp). Without bonds the atoms
// fly apart, which costs nothing more: there are no pair forces.
//   openmm_bonds [tolerance]      prints platform,system,ns_per_unit
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <vector>

#include "base/errors.hpp"
#include "molecules.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/import.hpp"

namespace taut::bench {
namespace {

struct Case {
  const char* name;
  Molecules molecules;
  double h;   // [ps]
  int units;  // bonds, or waters
};

OpenMMInput input_of(const Molecules& molecules, bool rigid) {
  OpenMMInput input;
  input.system = molecules.system();
  if (!rigid) input.system.bonds.clear();
  input.start = molecules.state();
  return input;
}

// Seconds a step, the best of many runs: what it takes when nothing else runs on its core.
double seconds_a_step(OpenMMTwin& twin) {
  using Clock = std::chrono::steady_clock;
  constexpr int kSteps = 20, kRuns = 25;
  twin.step(kSteps);
  std::vector<double> seconds;
  for (int run = 0; run < kRuns; ++run) {
    const auto begin = Clock::now();
    twin.step(kSteps);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - begin).count() / kSteps);
  }
  return *std::min_element(seconds.begin(), seconds.end());
}

void measure(const Case& c, const std::string& platform, double tolerance) {
  TwinSettings settings;
  settings.h = c.h;
  settings.constraint_tolerance = tolerance;
  settings.platform = platform;
  settings.threads = 1;
  OpenMMTwin rigid(input_of(c.molecules, true), settings), free(input_of(c.molecules, false), settings);
  const double ns = (seconds_a_step(rigid) - seconds_a_step(free)) * 1e9 / c.units;
  fmt::print("{},{},{:.1f}\n", platform, c.name, ns);
}

}  // namespace
}  // namespace taut::bench

int main(int argc, char** argv) {
  using namespace taut;
  if (!built_with_openmm()) return 3;
  const double tolerance = argc > 1 ? std::atof(argv[1]) : 1e-5;
  try {
    for (const char* platform : {"CPU", "Reference"}) {
      bench::measure({"chains-100x20", bench::chains(100, 20), 0.01, 2000}, platform, tolerance);
      bench::measure({"water-1000", bench::waters(1000), 0.001, 1000}, platform, tolerance);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
