#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

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

// What moves as a whole with the box: clusters of rigid bonds under c-rescale, molecules under monte-carlo, and of a
// molecule that meets its own image, which has no centre, its clusters. A cluster that meets its own image has none
// either. Its atoms can follow the box only by a motion that its bonds allow, M⁻¹Jᵀλ besides the scaling of all
// places, and how that stretches the volume of phase space would have to be known for the right distribution of volumes.
std::vector<int> moved_together(const Scene& scene) {
  const System& sys = scene.system;
  if (sys.images.periodic())
    throw InputError(
        fmt::format("run.barostat: atom {} is of a cluster of rigid bonds that goes around the box to its "
                    "own image, so that no change of the box keeps its bonds; take run.barostat = \"none\" "
                    "and measure the pressure at several boxes, or make the bonds through the box springs",
                    std::ranges::find(sys.reach, Reach::kCluster) - sys.reach.begin()));
  const std::vector<int> cluster = molecules(sys, {});
  if (scene.run.barostat == "c-rescale") return cluster;
  std::vector<int> group = molecules(sys, scene.terms);
  if (sys.reach.empty()) return group;
  std::map<std::pair<int, int>, int> number;  // of molecule and cluster
  for (int a = 0; a < sys.atoms(); ++a) {
    const int within = sys.reach_of(a) == Reach::kWhole ? -1 : cluster[a];
    group[a] = number.try_emplace({group[a], within}, static_cast<int>(number.size())).first->second;
  }
  return group;
}

}  // namespace

std::unique_ptr<Bath> make_barostat(const Scene& scene, std::uint64_t seed, RunForces& forces) {
  if (!scene.run.barostatted()) return nullptr;
  const System& sys = scene.system;
  const PressureCoupling coupling = pressure_coupling(scene.run, seed);
  if (scene.run.barostat == "c-rescale")
    return std::make_unique<CellRescaling>(sys, moved_together(scene), scene.start.box, coupling, forces);
  return std::make_unique<MonteCarloBarostat>(sys, moved_together(scene), coupling, forces);
}

}  // namespace taut
