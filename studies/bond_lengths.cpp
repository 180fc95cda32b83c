#include "studies/bond_lengths.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/series.hpp"
#include "studies/crosscheck_tables.hpp"

namespace taut {
namespace {

// The samples of a run that are evenly spaced, without the first fifth.
std::vector<const Sample*> even_samples(const Crosscheck& c, const Track& track) {
  std::vector<const Sample*> even;
  const long last = track.samples.back().step, every = last <= c.parting ? c.dense : c.every;
  for (const Sample& s : track.samples)
    if (s.step > 0 && s.step % every == 0 && 5 * s.step >= last) even.push_back(&s);
  return even;
}

BondLengths lengths_of(const Crosscheck& c, const Track& track, double Sample::*rms) {
  BondLengths of;
  of.run = track.name;
  std::vector<double> t, error, squares;
  for (const Sample* s : even_samples(c, track)) {
    t.push_back(s->t / 1000);
    error.push_back(s->*rms);
    squares.push_back(error.back() * error.back());
    of.largest = std::max(of.largest, s->bond_max);
  }
  const Estimate square = correlated_mean(squares);
  of.rms = {std::sqrt(square.value), square.value > 0 ? square.error / (2 * std::sqrt(square.value)) : 0.0};
  of.slope = block_slope(t, error);
  of.in_a_ns = std::abs(of.slope.value) + 2 * of.slope.error;
  of.drifts = c.long_enough && of.slope.error > 0 &&
              std::abs(of.slope.value) > std::max(4 * of.slope.error, of.rms.value);
  return of;
}

bool near(double a, double b) {
  return std::abs(a - b) <= 0.1 * b;
}

std::string made_of(const Crosscheck& c, const Track& track, const BondLengths& of, bool settle) {
  const bool openmm = track.name.starts_with("openmm");
  if (openmm && settle && near(of.rms.value, c.float_rounding)) return "lengths rounded to float";
  if (of.rms.value < 1e-14) return "rounding of positions";
  if (openmm) return settle ? "SETTLE's rounding" : "where CCMA stops, its tolerance";
  const bool of_law = track.name.starts_with("baumgarte") || track.name.starts_with("feedforward");
  return of_law ? "what one solve a step leaves" : track.setting;
}

}  // namespace

std::vector<BondLengths> bond_lengths(const Crosscheck& c) {
  std::vector<BondLengths> all;
  if (c.bonds == 0) return all;
  for (const Track* track : all_tracks(c)) {
    if (track->failed() || track->samples.size() < 2) continue;
    const bool openmm = track->name.starts_with("openmm") && c.plugged.empty();
    const auto add = [&](const char* algorithm, double Sample::*rms, bool settle) {
      BondLengths& of = all.emplace_back(lengths_of(c, *track, rms));
      of.made_of = made_of(c, *track, of, settle);
      of.run += algorithm;
    };
    if (!openmm) {
      add("", &Sample::bond_rms, false);
      continue;
    }
    if (c.settled > 0) add(", SETTLE", &Sample::settle_rms, true);
    if (c.settled < c.bonds) add(", CCMA", &Sample::ccma_rms, false);
  }
  return all;
}

std::string bond_lengths_in_words(const Crosscheck& c) {
  const std::vector<BondLengths> all = bond_lengths(c);
  const auto of = [&](const std::string& run) -> std::string {
    for (const BondLengths& each : all)
      if (each.run == run || each.run.starts_with(run + ", "))
        return fmt::format("{:.1e} rms ({}), which a nanosecond changes by at most {:.0e}", each.rms.value,
                           each.made_of, each.in_a_ns);
    return "";
  };
  if (c.tracks.empty() || c.tracks[0].failed() || c.twin.failed()) return "";
  std::vector<std::string> drifting;
  for (const BondLengths& each : all)
    if (each.drifts) drifting.push_back(each.run);
  std::string text = fmt::format("{}'s bonds are off by {}; OpenMM's by {}", c.tracks[0].name,
                                 of(c.tracks[0].name), of(c.twin.name));
  text += !c.long_enough ? "; whether they drift is told by runs of 5 ps and more"
          : drifting.empty()
              ? "; none drifts within its error"
              : fmt::format("; {} drift{}", fmt::join(drifting, ", "), drifting.size() == 1 ? "s" : "");
  if (!c.nudged.failed())
    text += fmt::format(
        "; chaos has no part in it: OpenMM's run from 1e-10 nm beside has {:.2g} times that error",
        c.nudged.rms_bond(c.parting) / std::max(1e-300, c.twin.rms_bond(c.parting)));
  return text;
}

}  // namespace taut
