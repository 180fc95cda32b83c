#include <fmt/format.h>

#include "base/errors.hpp"
#include "ensembles/c_rescale.hpp"
#include "ensembles/monte_carlo.hpp"
#include "md/units.hpp"
#include "simulation/inner.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

PressureCoupling pressure_coupling(const RunSettings& run, std::uint64_t seed) {
  if (run.barostat_every < 1)
    throw InputError(fmt::format("run.barostat_every is {}, expected 1 or more", run.barostat_every));
  const std::array<int, 3> all = {0, 0, 0}, none = {0, 1, 2}, x_and_y = {0, 0, 1};
  return {.pressure = run.pressure_bar / kBarPerUnit,
          .kT = kBoltzmann * run.temperature_k,
          .every = run.barostat_every,
          .time_between = static_cast<double>(run.barostat_every) * run.h(),
          .relaxation = run.barostat_ps,
          .compressibility = run.compressibility_per_bar * kBarPerUnit,
          .alike = run.coupling == "anisotropic"      ? none
                   : run.coupling == "semi-isotropic" ? x_and_y
                                                      : all,
          .seed = seed};
}

}  // namespace

std::unique_ptr<Bath> make_barostat(const Scene& scene, std::uint64_t seed, RunForces& forces) {
  if (!scene.run.barostatted()) return nullptr;
  const System& sys = scene.system;
  const PressureCoupling coupling = pressure_coupling(scene.run, seed);
  if (scene.run.barostat == "c-rescale")
    return std::make_unique<CellRescaling>(sys, molecules(sys, {}), scene.start.box, coupling, forces);
  return std::make_unique<MonteCarloBarostat>(sys, molecules(sys, scene.terms), coupling, forces);
}

}  // namespace taut
