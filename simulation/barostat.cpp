#include "simulation/barostat.hpp"

#include <cmath>

#include "md/units.hpp"
#include "systems/whole_molecules.hpp"

namespace taut {
CellRescaling::CellRescaling(const System& sys, const RunSettings& run, std::uint64_t seed,
                             ForceField& forces)
    : centres_(sys, molecules(sys, {})),
      forces_(forces),
      alike_(run.coupling == "anisotropic"      ? std::array{0, 1, 2}
             : run.coupling == "semi-isotropic" ? std::array{0, 0, 1}
                                                : std::array{0, 0, 0}),
      pressure_(run.pressure_bar / kBarPerUnit),
      kT_(kBoltzmann * run.temperature_k),
      compressibility_(run.compressibility_per_bar * kBarPerUnit),
      kept_(std::exp(-static_cast<double>(run.barostat_every) * run.h() / run.barostat_ps)),
      every_(run.barostat_every),
      random_(seed) {}

Vec3 CellRescaling::pressure(const State& s, const Vectors& F) const {
  return (centres_.twice_kinetic(s.v) + forces_.virial(s.x).diagonal() - centres_.inner_virial(s.x, F)) /
         s.box.volume();
}

void CellRescaling::after_step(const State& s, const Vectors& F) {
  if (++steps_ % every_ != 0) return;
  const double V = s.box.volume();
  const Vec3 P = pressure(s, F);
  for (int kind = 0; kind <= alike_[2]; ++kind) {
    double k = 0, sum = 0;
    for (int d = 0; d < 3; ++d) {
      if (alike_[d] != kind) continue;
      ++k;
      sum += P[d];
    }
    const double beta = k * compressibility_ / 3;
    const double strain = beta * (1 - kept_) * (sum / k - pressure_) +
                          std::sqrt((1 - kept_ * kept_) * kT_ * beta / V) * random_.normal();
    for (int d = 0; d < 3; ++d)
      if (alike_[d] == kind) strain_[d] = strain / k;
  }
}

double CellRescaling::move(const System&, State& s) {
  if (strain_.isZero(0)) return 0;
  const Vec3 mu = strain_.array().exp(), twice_kinetic = centres_.twice_kinetic(s.v);
  centres_.scale_positions(mu, s.x);
  centres_.scale_velocities(mu, s.v);
  s.box = s.box.scaled(mu);
  strain_.setZero();
  return 0.5 * twice_kinetic.dot(mu.cwiseAbs2().cwiseInverse() - Vec3::Ones());
}

MonteCarloBarostat::MonteCarloBarostat(const System& sys, const std::vector<int>& molecule,
                                       const RunSettings& run, std::uint64_t seed, ForceField& forces)
    : centres_(sys, molecule),
      forces_(forces),
      pressure_(run.pressure_bar / kBarPerUnit),
      kT_(kBoltzmann * run.temperature_k),
      every_(run.barostat_every),
      random_(seed) {}

double MonteCarloBarostat::energy(const System& sys) {
  forces_(sys, trial_);
  return forces_.potential();
}

double MonteCarloBarostat::move(const System& sys, State& s) {
  if (steps_ == 0 || steps_ % every_ != 0) return 0;
  trial_.x = s.x;
  trial_.box = s.box;
  const double V = s.box.volume(), before = energy(sys);
  if (largest_ == 0) largest_ = 0.01 * V;
  const double to = V + largest_ * (2 * random_.uniform() - 1), chance = random_.uniform();
  if (to > 0) {
    const Vec3 mu = Vec3::Constant(std::cbrt(to / V));
    centres_.scale_positions(mu, trial_.x);
    trial_.box = s.box.scaled(mu);
    const double W = energy(sys) - before + pressure_ * (to - V) - centres_.groups() * kT_ * std::log(to / V);
    if (chance < std::exp(-W / kT_)) {
      s.x = trial_.x;
      s.box = trial_.box;
      ++taken_;
    }
  }
  if (++tried_ == kTrials) adapt();
  return 0;
}

void MonteCarloBarostat::adapt() {
  const double by = 1 + std::min(0.1, 2.0 / static_cast<double>(++adapted_));
  if (taken_ < 0.25 * kTrials) largest_ /= by;
  if (taken_ > 0.75 * kTrials) largest_ *= by;
  tried_ = taken_ = 0;
}

std::unique_ptr<Barostat> make_barostat(const Scene& scene, std::uint64_t seed, ForceField& forces) {
  const RunSettings& run = scene.run;
  const System& sys = scene.system;
  if (!run.barostatted()) return nullptr;
  if (run.barostat == "c-rescale") return std::make_unique<CellRescaling>(sys, run, seed, forces);
  return std::make_unique<MonteCarloBarostat>(sys, molecules(sys, scene.terms), run, seed, forces);
}

}  // namespace taut
