#include "studies/crosscheck_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/exceeds.hpp"
#include "studies/bond_lengths.hpp"
#include "studies/crosscheck_tables.hpp"

namespace taut {
namespace {

constexpr double kHeld = 1e-9;             // relative bond error of a method that holds its bonds
constexpr double kLost = 1e-6;             // above which OpenMM's own do not: floats leave 6e-8
constexpr double kSameEnergy = 1e-8;       // relative
constexpr double kSameForce = 1e-6;        // of the forces' rms
constexpr double kSinglePrecision = 1000;  // times those, where OpenMM computes in it
constexpr double kSurprising = 4;          // standard errors
// What a run that round-off alone sets apart may have been off at the start [nm]: in double precision, and where
// forces are in single, which puts a pair at the cutoff on its other side a step early or late; and a share of the
// largest coordinate where positions are, too.
constexpr double kRoundOff = 1e-12, kRoundOffOfForces = 5e-6, kRoundOffOfPositions = 2e-6;

double round_off(const Crosscheck& c) {
  if (c.in_double) return kRoundOff;
  if (c.platform == "CPU" || c.precision == "mixed") return kRoundOffOfForces;
  return std::max(kRoundOffOfForces, kRoundOffOfPositions * c.extent);
}

constexpr const char* kGaveUp = "its CCMA gave up at 150 iterations, without a word";

// A run that broke. OpenMM's own may have lost the bonds before they lost the numbers.
Verdict on_failure(const Crosscheck& c, const Track& track) {
  std::string why = track.failure;
  const bool of_openmm = c.plugged.empty() && track.name.starts_with("openmm");
  if (of_openmm && track.worst_bond() > kLost)
    why += fmt::format("; its bonds were off by {:.1e} before: {}", track.worst_bond(), kGaveUp);
  return {track.name, Finding::kFailed, why};
}

Verdict on_start(const Crosscheck& c) {
  const auto& s = c.start;
  const double scale = std::max(std::abs(s.energy), 1e-3);  // a system without forces has no energy
  const double energy = std::abs(s.energy - s.openmm_energy) / scale;
  const double force = s.force_rms > 0 ? s.force_difference / s.force_rms : s.force_difference;
  const bool exact = c.in_double;
  const double slack = exact ? 1 : kSinglePrecision;
  return {"start",
          energy <= slack * kSameEnergy && force <= slack * kSameForce ? Finding::kAgrees : Finding::kDiffers,
          fmt::format("energy to {:.1e} of itself, forces to {:.1e} of their rms{}", energy, force,
                      exact ? "" : "; pair forces are in single precision there, so runs part at once")};
}

Verdict on_leapfrog(const Crosscheck& c) {
  const auto& l = c.leapfrog;
  if (!l.failure.empty()) return {"openmm verlet", Finding::kFailed, l.failure};
  const bool same = l.positions <= c.agreement;
  return {"openmm verlet", same ? Finding::kAgrees : Finding::kDiffers,
          fmt::format(
              "leap-frog takes RATTLE's positions ({:.1e} nm apart after {} steps); the velocities it keeps "
              "lag by half a step ({:.1e} nm/ps off), brought to the full step they are {:.1e} off",
              l.positions, l.steps, l.velocities_kept, l.velocities)};
}

Verdict on_openmm_bonds(const Crosscheck& c) {
  const auto& b = c.openmm_bonds;
  std::string why = fmt::format("relative bond error up to {:.1e}", b.worst);
  if (!b.failure.empty()) return {"openmm bonds", Finding::kFailed, why + "; " + b.failure};
  if (b.rounded > 0)
    why += fmt::format(
        ": SETTLE holds {} of {} bonds at the float nearest their length; newton told to do so stays "
        "within {:.1e} nm of it for {} steps, with the lengths as given {:.1e}",
        b.rounded, c.bonds, *b.apart_with_theirs, b.steps, *b.apart_as_given);
  else if (b.worst > kHeld)
    why += fmt::format(": {}", kGaveUp);
  else
    why += ": its CCMA converged";
  const bool explained = b.rounded == 0 || *b.apart_with_theirs <= c.agreement;
  return {"openmm bonds", !explained || b.worst > kLost ? Finding::kDiffers : Finding::kAgrees, why};
}

// What OpenMM's rounded lengths have to do with it: all, if newton told to hold those does not part.
std::string rounding_clause(const Crosscheck& c) {
  const auto& b = c.openmm_bonds;
  if (!c.in_double) return "";  // there the forces differ too
  if (b.rounded == 0 || *b.apart_with_theirs > 0.01 * *b.apart_as_given) return "";
  return fmt::format(
      "; from OpenMM's lengths, rounded to float: newton with those is {:.1e} nm from it after {} steps",
      *b.apart_with_theirs, b.steps);
}

// How far apart two runs had to be at the start for chaos alone to take them so far [nm].
double apart_at_start(const Crosscheck& c, const Track& track) {
  return track.apart_at(c.chaos.steps) / std::max(1.0, c.chaos.growth);
}

std::string chaos_clause(const Crosscheck& c, const Track& track) {
  if (!(c.chaos.growth > 1) || c.nudged.failed()) return "";
  return fmt::format("; what {:.0e} nm at the start would do (chaos: ×{:.2g} in {} steps)",
                     apart_at_start(c, track), c.chaos.growth, c.chaos.steps);
}

// The last sample at which the fine run was there.
const Sample* last_judged(const Track& track) {
  const Sample* last = nullptr;
  for (const Sample& s : track.samples)
    if (s.from_truth >= 0) last = &s;
  return last;
}

// Who is nearer the truth.
std::string truth_clause(const Crosscheck& c, const Track& track) {
  const Sample *ours = last_judged(track), *theirs = last_judged(c.twin);
  if (ours == nullptr || theirs == nullptr || ours->step != theirs->step) return "";
  const double a = ours->from_truth, b = theirs->from_truth;
  const std::string pair =
      fmt::format(" the fine run ({:.1e} nm, OpenMM {:.1e}, at step {})", a, b, ours->step);
  if (std::abs(a - b) <= 0.1 * std::max(a, b)) return "; as near" + pair;
  return (a < b ? "; nearer" : "; farther from") + pair;
}

std::string residual_clause(const Track& track) {
  return fmt::format("; its own bonds are off by {:.1e} rms, {:.1e} at most",
                     track.rms_bond(track.samples.back().step), track.worst_bond());
}

Verdict on_method(const Crosscheck& c, const Track& track) {
  const auto parted = track.parted_at(c.agreement);
  std::string why = parted ? fmt::format("at step {}: {:.1e} nm apart after {}", *parted,
                                         track.apart_at(c.parting), c.parting)
                           : fmt::format("{:.1e} nm apart at most in {} steps", track.most_apart(), c.steps);
  const bool holds = track.worst_bond() <= kHeld;
  if (!holds) why += residual_clause(track);
  if (parted && holds)
    why += c.openmm_bonds.worst > kLost
               ? fmt::format("; OpenMM's own bonds are off by {:.1e}", c.openmm_bonds.worst)
               : rounding_clause(c) + chaos_clause(c, track);
  if (parted) why += truth_clause(c, track);
  return {track.name, parted ? Finding::kParts : Finding::kAgrees, why};
}

Verdict on_its_own(const Crosscheck& c, const Track& track, const Track& other) {
  return {
      track.name, Finding::kAlone,
      fmt::format("got through its {} steps; {} did not: nothing is judged beside it", c.steps, other.name)};
}

// The plug-in's run beside taut's own, which round-off alone sets apart.
Verdict on_plugin(const Crosscheck& c, const Track& track) {
  return {track.name, apart_at_start(c, track) <= round_off(c) ? Finding::kAgrees : Finding::kParts,
          fmt::format("{:.1e} nm from taut's own run after {} steps{}; round-off is up to {:.0e} nm there",
                      track.apart_at(c.chaos.steps), c.chaos.steps, chaos_clause(c, track), round_off(c))};
}

// Averages of a long run, in standard errors.
Verdict on_averages(const Track& track, const Track& twin) {
  const double kelvin = deviations(track.temperature, twin.temperature);
  double worst = kelvin;
  std::string why = fmt::format("T {:.2f} ± {:.2f} K, OpenMM {:.2f} ± {:.2f} ({:.1f} standard errors)",
                                track.temperature.value, track.temperature.error, twin.temperature.value,
                                twin.temperature.error, kelvin);
  if (!track.oxygens.r.empty()) {
    const double chi = chi_squared(track.oxygens, twin.oxygens);
    why += fmt::format("; O–O g(r): χ² {:.2f} a bin", chi);
    if (exceeds(chi, worst)) worst = chi;
  }
  if (track.end_to_end.value > 0) {
    const double ends = deviations(track.end_to_end, twin.end_to_end);
    why += fmt::format("; end to end {:.4f} ± {:.4f} nm, OpenMM {:.4f} ± {:.4f} ({:.1f})",
                       track.end_to_end.value, track.end_to_end.error, twin.end_to_end.value,
                       twin.end_to_end.error, ends);
    if (exceeds(ends, worst)) worst = ends;
  }
  return {track.name + ", averages", worst <= kSurprising ? Finding::kAgrees : Finding::kDiffers, why};
}

// Whether it gains or loses energy as OpenMM does.
Verdict on_energy(const Track& track, const Track& twin) {
  const Estimate &ours = track.drift, &theirs = twin.drift;
  const double apart = deviations(ours, theirs);
  std::string why =
      fmt::format("drift {:.1e} ± {:.0e} kJ/mol/ns/dof, OpenMM {:.1e} ± {:.0e} ({:.1f} standard errors)",
                  ours.value, ours.error, theirs.value, theirs.error, apart);
  if (track.constraint_drift)
    why += fmt::format(", of which constraints {:.1e}", track.constraint_drift->value);
  const bool same = apart <= kSurprising;
  if (!same)
    why += std::abs(ours.value) > std::abs(theirs.value) ? "; it keeps energy worse"
                                                         : "; it keeps energy better";
  return {track.name + ", energy", same ? Finding::kAgrees : Finding::kDiffers, why};
}

}  // namespace

std::string_view name_of(Finding finding) {
  switch (finding) {
    case Finding::kAgrees:
      return "agrees";
    case Finding::kParts:
      return "parts";
    case Finding::kDiffers:
      return "differs";
    case Finding::kAlone:
      return "alone";
    case Finding::kFailed:
      break;
  }
  return "failed";
}

double chi_squared(const Distances& a, const Distances& b) {
  double sum = 0;
  int bins = 0;
  for (std::size_t n = 0; n < std::min(a.g.size(), b.g.size()); ++n) {
    if (a.g[n].error + b.g[n].error == 0) continue;
    sum += std::pow(deviations(a.g[n], b.g[n]), 2);
    ++bins;
  }
  return bins > 0 ? sum / bins : 0.0;
}

std::vector<Verdict> verdicts(const Crosscheck& c) {
  std::vector<Verdict> all;
  for (const Track* track : all_tracks(c))
    if (track->failed()) all.push_back(on_failure(c, *track));
  all.push_back(on_start(c));
  const auto on_run = [&](const Track& track, const Track& other, const auto& judge) {
    if (track.failed()) return;  // named above
    all.push_back(other.failed() ? on_its_own(c, track, other) : judge(c, track));
  };
  const auto in_the_long_run = [&](const Track& track, const Track& twin) {
    if (!c.long_enough || track.failed() || twin.failed()) return;
    all.push_back(on_averages(track, twin));
    all.push_back(on_energy(track, twin));
  };
  for (const auto& [ours, theirs] : c.plugged) on_run(theirs, ours, on_plugin);
  for (const auto& [ours, theirs] : c.plugged) in_the_long_run(ours, theirs);
  if (!c.plugged.empty()) return all;
  if (!c.twin.failed()) {
    if (!c.verlet.failed()) all.push_back(on_leapfrog(c));
    if (c.bonds > 0) all.push_back(on_openmm_bonds(c));
  }
  if (const std::string lengths = bond_lengths_in_words(c); !lengths.empty())
    all.push_back(
        {"bond lengths",
         std::ranges::any_of(bond_lengths(c), &BondLengths::drifts) ? Finding::kDiffers : Finding::kAgrees,
         lengths});
  for (const Track& track : c.tracks) on_run(track, c.twin, on_method);
  for (const Track& track : c.tracks) in_the_long_run(track, c.twin);
  return all;
}

std::string headline(const Crosscheck& c) {
  const std::vector<Verdict> all = verdicts(c);
  const auto of = [&](Finding finding) { return std::ranges::find(all, finding, &Verdict::finding); };
  if (const auto failed = of(Finding::kFailed); failed != all.end())
    return fmt::format("failed: {}: {}", failed->who, failed->why);
  if (const auto differs = of(Finding::kDiffers); differs != all.end())
    return fmt::format("differs: {}: {}", differs->who, differs->why);
  if (!c.plugged.empty())
    return of(Finding::kParts) == all.end()
               ? fmt::format("agrees: the plug-in takes taut's own trajectory, to round-off ({:.0e} nm)",
                             round_off(c))
               : fmt::format("differs: {}: {}", of(Finding::kParts)->who, of(Finding::kParts)->why);
  if (c.tracks.empty()) return "agrees at the start; no method was asked for";
  const Track& track = c.tracks.front();
  const auto& b = c.openmm_bonds;
  const auto parted = track.parted_at(c.agreement);
  if (!parted)
    return fmt::format("agrees: taut's {} is OpenMM's run to {:.1e} nm over {} steps", track.name,
                       track.most_apart(), c.steps);
  const std::string rest =
      fmt::format("from step {} on they are more than {:.0e} nm apart", *parted, c.agreement);
  if (!rounding_clause(c).empty())
    return fmt::format(
        "agrees: taut's {} is OpenMM's run to {:.1e} nm over {} steps where both hold the same "
        "lengths; as given {}, by OpenMM's rounding of lengths to float, which chaos enlarges",
        track.name, *b.apart_with_theirs, b.steps, rest);
  return fmt::format(
      "agrees: taut's {} is OpenMM's run until chaos parts them: {}, which {:.0e} nm at the start "
      "would do, too",
      track.name, rest, apart_at_start(c, track));
}

}  // namespace taut
