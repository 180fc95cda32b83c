#include "ensembles/c_rescale.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "md/step_parts.hpp"

namespace taut {
namespace {

constexpr double kApart = 10;  // times further apart than at the start may edges be

std::string in_words(const Vec3& edge) {
  return fmt::format("{:.4g} × {:.4g} × {:.4g} nm", edge.x(), edge.y(), edge.z());
}

}  // namespace

CellRescaling::CellRescaling(const System& sys, const std::vector<int>& group, const Box& start,
                             const PressureCoupling& coupling, RunForces& forces)
    : centres_(sys, group),
      forces_(forces),
      coupling_(coupling),
      start_(start.edge),
      kept_(std::exp(-coupling.time_between / coupling.relaxation)),
      random_{coupling.seed} {}

Vec3 CellRescaling::pressure(double h, const State& s) const {
  const Vec3 virial =
      forces_.field.virial(s, forces_.evaluation).diagonal() - centres_.inner_virial(s.x, s.F);
  return (centres_.twice_kinetic(s.v, 0.5 * h, s.f) + virial) / s.box.volume();
}

double CellRescaling::after_step(const System&, double h, State& s) {
  if (++steps_ % coupling_.every != 0) return 0;
  const PartScope here(StepPart::kBarostat);
  const double V = s.box.volume();
  const Vec3 P = pressure(h, s);
  RandomOfStep random = random_.next(Stream::kCellRescaling);
  for (int kind = 0; kind <= coupling_.alike[2]; ++kind) {
    double k = 0, sum = 0;
    for (int d = 0; d < 3; ++d) {
      if (coupling_.alike[d] != kind) continue;
      ++k;
      sum += P[d];
    }
    const double beta = k * coupling_.compressibility / 3;
    const double strain = beta * (1 - kept_) * (sum / k - coupling_.pressure) +
                          std::sqrt((1 - kept_ * kept_) * coupling_.kT * beta / V) * random.normal();
    for (int d = 0; d < 3; ++d)
      if (coupling_.alike[d] == kind) strain_[d] = strain / k;
  }
  return 0;
}

double CellRescaling::move_box(const System&, State& s) {
  if (strain_.isZero(0)) return 0;
  const PartScope here(StepPart::kBarostat);
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
      coupling_.alike[2] == 0 ? ""
                              : ", or run.coupling = \"isotropic\": a fluid does not hold its box's shape";
  if (const std::string flaw = forces_.field.lack_of_room(box); !flaw.empty())
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

}  // namespace taut
