#include "simulation/barostat.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "md/units.hpp"
#include "systems/whole_molecules.hpp"

namespace taut {
namespace {

constexpr double kApart = 10;  // times further apart than at the start may edges be

std::string in_words(const Vec3& edge) {
  return fmt::format("{:.4g} × {:.4g} × {:.4g} nm", edge.x(), edge.y(), edge.z());
}

// Which edges change alike, by numbers.
std::array<int, 3> alike(const std::string& coupling) {
  if (coupling == "anisotropic") return {0, 1, 2};
  if (coupling == "semi-isotropic") return {0, 0, 1};
  return {0, 0, 0};
}

}  // namespace

CellRescaling::CellRescaling(const Scene& scene, std::uint64_t seed, ForceField& forces)
    : centres_(scene.system, molecules(scene.system, {})),
      forces_(forces),
      start_(scene.start.box.edge),
      alike_(alike(scene.run.coupling)),
      pressure_(scene.run.pressure_bar / kBarPerUnit),
      kT_(kBoltzmann * scene.run.temperature_k),
      compressibility_(scene.run.compressibility_per_bar * kBarPerUnit),
      kept_(std::exp(-static_cast<double>(scene.run.barostat_every) * scene.run.h() / scene.run.barostat_ps)),
      every_(scene.run.barostat_every),
      random_{seed} {}

Vec3 CellRescaling::pressure(const State& s, const Vectors& F, const ForceField::Evaluation& besides) const {
  return (centres_.twice_kinetic(s.v) + forces_.virial(s, besides).diagonal() -
          centres_.inner_virial(s.x, F)) /
         s.box.volume();
}

void CellRescaling::after_step(const State& s, const Vectors& F, const ForceField::Evaluation& besides) {
  if (++steps_ % every_ != 0) return;
  const double V = s.box.volume();
  const Vec3 P = pressure(s, F, besides);
  RandomOfStep random = random_.next(Stream::kCellRescaling);
  for (int kind = 0; kind <= alike_[2]; ++kind) {
    double k = 0, sum = 0;
    for (int d = 0; d < 3; ++d) {
      if (alike_[d] != kind) continue;
      ++k;
      sum += P[d];
    }
    const double beta = k * compressibility_ / 3;
    const double strain = beta * (1 - kept_) * (sum / k - pressure_) +
                          std::sqrt((1 - kept_ * kept_) * kT_ * beta / V) * random.normal();
    for (int d = 0; d < 3; ++d)
      if (alike_[d] == kind) strain_[d] = strain / k;
  }
}

double CellRescaling::move(const System&, State& s) {
  if (strain_.isZero(0)) return 0;
  const Vec3 mu = strain_.array().exp(), twice_kinetic = centres_.twice_kinetic(s.v);
  demand_sound(s.box.scaled(mu));
  centres_.scale_positions(mu, s.x);
  centres_.scale_velocities(mu, s.v);
  s.box = s.box.scaled(mu);
  strain_.setZero();
  return 0.5 * twice_kinetic.dot(mu.cwiseAbs2().cwiseInverse() - Vec3::Ones());
}

void CellRescaling::demand_sound(const Box& box) const {
  const std::string one_shape =
      alike_[2] == 0 ? "" : ", or run.coupling = \"isotropic\": a fluid does not hold its box's shape";
  if (const std::string flaw = forces_.lack_of_room(box); !flaw.empty())
    throw SimulationFailure(
        fmt::format("the box has shrunk to {} under the barostat (c-rescale): {}; take a larger system or a "
                    "shorter cutoff{}",
                    in_words(box.edge), flaw, one_shape));
  const Vec3 grown = box.edge.cwiseQuotient(start_);
  if (!(grown.maxCoeff() <= kApart * grown.minCoeff()))
    throw SimulationFailure(
        fmt::format("the box has run to {} under the barostat (c-rescale, {} at the start); take "
                    "run.coupling = \"isotropic\": nothing holds the box's shape, as in a fluid",
                    in_words(box.edge), in_words(start_)));
}

MonteCarloBarostat::MonteCarloBarostat(const System& sys, const std::vector<int>& molecule,
                                       const RunSettings& run, std::uint64_t seed, ForceField& forces)
    : centres_(sys, molecule),
      forces_(forces),
      pressure_(run.pressure_bar / kBarPerUnit),
      kT_(kBoltzmann * run.temperature_k),
      every_(run.barostat_every),
      random_{seed} {}

double MonteCarloBarostat::energy(const System& sys) {
  return forces_.evaluate_energy(sys, trial_);
}

double MonteCarloBarostat::move(const System& sys, State& s) {
  if (steps_ == 0 || steps_ % every_ != 0) return 0;
  trial_.x = s.x;
  trial_.box = s.box;
  const double V = s.box.volume(), before = energy(sys);
  if (largest_ == 0) largest_ = 0.01 * V;
  RandomOfStep random = random_.next(Stream::kMonteCarlo);
  const double to = V + largest_ * (2 * random.uniform() - 1), chance = random.uniform();
  const Vec3 mu = Vec3::Constant(std::cbrt(std::max(to, 0.0) / V));
  trial_.box = s.box.scaled(mu);
  const bool too_narrow = !forces_.lack_of_room(trial_.box).empty();
  ++trials_;
  too_narrow_ += too_narrow;
  if (to > 0 && !too_narrow) {
    centres_.scale_positions(mu, trial_.x);
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

std::string MonteCarloBarostat::doubt() const {
  if (too_narrow_ == 0) return "";
  return fmt::format(
      "the barostat refused {} of {} trial boxes as too narrow for the cutoff, which keeps the volume up; "
      "take "
      "a larger system or a shorter cutoff",
      too_narrow_, trials_);
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
  if (run.barostat_every < 1)
    throw InputError(fmt::format("run.barostat_every is {}, expected 1 or more", run.barostat_every));
  if (run.barostat == "c-rescale") return std::make_unique<CellRescaling>(scene, seed, forces);
  return std::make_unique<MonteCarloBarostat>(sys, molecules(sys, scene.terms), run, seed, forces);
}

}  // namespace taut
