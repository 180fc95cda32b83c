#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/functions.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

constexpr std::size_t kMostTypes = 500;
// CHARMM's force switch is an energy of its own.
constexpr const char* kRemedy = "; to switch Lennard-Jones off give the force a switchingDistance";

const std::vector<KnownEnergy>& known() {
  static const std::vector<KnownEnergy> kAll = {
      {kWcaEnergy, {{"sigma"}, {"epsilon"}}, "1.122462048309373*sigma-r"},
      {kLennardJonesEnergy, {}}};  // known by its values, below
  return kAll;
}

double largest_jump(const TabulatedPairs& pairs) {
  double most = 0;
  for (const auto& potential : pairs.potentials)
    most = std::max(most, std::abs(potential.energy->values().back()));
  return most;
}

constexpr double kFarther = std::numeric_limits<double>::infinity();

// Finds a and b of an energy a/r¹² − b/r⁶: b from a large distance, a from a small one. Between them the
// energy must agree.
struct PowerLaw {
  bool fits = true;
  double a, b;

  template <class Energy>
  explicit PowerLaw(const Energy& energy) {
    const auto inv_r6 = [](double r) { return std::pow(r, -6); };
    constexpr double kFar = 1e3, kClose = 1e-3;  // [nm]
    b = -energy(kFar) / inv_r6(kFar);
    a = (energy(kClose) / inv_r6(kClose) + b) / inv_r6(kClose);
    if (std::abs(a) < 1e-20 * std::abs(b)) a = 0;  // a is rounding error
    if (std::abs(b) < 1e-12 * std::abs(a)) b = 0;
    for (const double r : {0.02, 0.1, 0.17, 0.25, 0.33, 0.41, 0.6, 0.9, 1.2, 3.0}) {
      const double u = inv_r6(r);
      fits = fits && std::abs(energy(r) - (a * u - b) * u) <= 1e-9 * (std::abs(a * u) + std::abs(b)) * u;
    }
  }
  Expression::Rough up_to(double reach, double r) const {
    if (!(r < reach)) return {0, kFarther};
    const double u = std::pow(r, -6);
    return {(a * u - b) * u, 1e-9 * (std::abs(a * u) + std::abs(b)) * u};
  }
};

// The atoms that are in no group where there is one, of atoms with themselves.
std::vector<int> read_without(const ForceReading& r) {
  const Element groups = r.force.part("InteractionGroups");
  const int atoms = r.system.atoms();
  std::vector<std::set<int>> sets;
  const auto read_set = [&](const Element& set) {
    std::set<int>& to = sets.emplace_back();
    set.each("Particle", [&](const Element& particle) {
      int a = 0;
      particle.read_leaf({atom_field("index", a, atoms)});
      to.insert(a);
    });
  };
  groups.each("InteractionGroup", [&](const Element& group) {
    group.check_parts({"Set1", "Set2"});
    for (const char* set : {"Set1", "Set2"}) read_set(group.part(set));
  });
  if (sets.empty()) return {};
  if (sets.size() > 2 || sets[0] != sets[1])
    groups.refuse("has pairs of some groups alone; taut takes one group, of atoms with themselves");
  std::vector<int> without;
  for (int a = 0; a < atoms; ++a)
    if (!sets[0].contains(a)) without.push_back(a);
  return without;
}

void read_wca(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x) {
  Wca& wca = r.to.terms.wca.emplace(Wca{p.of_all("sigma"), p.factor() * p.of_all("epsilon"), {}});
  if (x.method == NonbondedXml::kNoCutoff || !(std::abs(x.cutoff - wca.cutoff()) < 1e-12 * wca.sigma))
    r.force.refuse("is not cut off at 2^(1/6) sigma, as taut's repulsive beads are");
  if (x.switched) r.force.refuse("has useSwitchingFunction=\"1\": taut's repulsive beads have no switch");
  if (x.corrected) r.force.refuse("has useLongRangeCorrection=\"1\": nothing is beyond the cutoff");
  r.force.part("Particles").each("Particle", [&](const Element& particle) { p.read(particle, {}); });
  read_list(r.force, wca.exclusions, r.system.atoms());
  wca.without = read_without(r);
}

// Atoms of the same parameters are of one type.
using AtomTypes = std::map<std::vector<double>, int>;
AtomTypes read_types(const ForceReading& r, CustomForce& p, std::vector<int>& of_atom) {
  AtomTypes types;
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    p.read(particle, {});
    of_atom.push_back(types.emplace(p.of_term(), static_cast<int>(types.size())).first->second);
    if (types.size() > kMostTypes)
      particle.refuse(fmt::format(
          "is of a type of its own, as are more than {} atoms: taut takes no more types", kMostTypes));
  });
  return types;
}

constexpr const char* kNotMutual =
    "has another energy between two atoms when they are named the other way round";

void read_powers(const ForceReading& r, CustomForce& p, double reach, LennardJonesTable& table) {
  const AtomTypes types = read_types(r, p, table.type);
  const auto n = static_cast<Eigen::Index>(types.size());
  table.a = table.b = Eigen::MatrixXd::Zero(n, n);
  for (const auto& one : types)
    for (const auto& two : types) {
      const PowerLaw law([&](double at) { return p.pair_energy(one.first, two.first, at); });
      const auto within_reach = [&](double at) { return law.up_to(reach, at); };
      if (!law.fits || (p.branches() && !p.is(within_reach, one.first, two.first)))
        p.refuse_energy(known(), kRemedy);
      table.a(one.second, two.second) = law.a;
      table.b(one.second, two.second) = law.b;
    }
  const auto uneven = [](const Eigen::MatrixXd& m) {
    return ((m - m.transpose()).array().abs() > 1e-12 * m.array().abs()).any();
  };
  if (uneven(table.a) || uneven(table.b)) r.force.refuse(kNotMutual);
}

void read_lennard_jones(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x) {
  Nonbonded& lj = r.to.lennard_jones.emplace();
  const double reach = x.method == NonbondedXml::kNoCutoff ? kFarther : x.cutoff;
  read_powers(r, p, reach, lj.lj_table.emplace());
  std::vector<std::array<int, 2>> exclusions;
  read_list(r.force, exclusions, r.system.atoms());
  for (const auto& [i, j] : exclusions) lj.exceptions.push_back({i, j, 0, 1, 0});
  lj.dispersion_correction = x.corrected && *r.to.periodic_pairs;
  if (x.method == NonbondedXml::kNoCutoff) return;
  lj.cutoff = x.cutoff;
  if (x.switched) lj.switch_distance = x.switch_distance;
}

bool is_zero(const Splines& splines, const std::function<double(double)>& energy) {
  for (const auto& [name, spline] : splines)
    for (const double share : {0.0, 0.07, 0.31, 0.5, 0.83})
      if (energy(spline->first() + share * (spline->last() - spline->first())) != 0) return false;
  return true;
}

// Continuous functions of the distance, as taut's tables: each pair of types has one, or a multiple of it, or none.
void read_tabulated(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x,
                    const Splines& splines) {
  TabulatedPairs& to = r.to.terms.tabulated_pairs.emplace();
  const AtomTypes types = read_types(r, p, to.kind);
  const bool cut = x.method != NonbondedXml::kNoCutoff;
  if (x.switched)
    r.force.refuse("has useSwitchingFunction=\"1\": taut's tables have no switch; write it into the table");
  if (x.corrected) r.force.refuse("has useLongRangeCorrection=\"1\": nothing is beyond a table");
  for (auto one = types.begin(); one != types.end(); ++one)
    for (auto two = one; two != types.end(); ++two) {
      const auto energy = [&](double at) { return p.pair_energy(one->first, two->first, at); };
      const auto swapped = [&](double at) { return p.pair_energy(two->first, one->first, at); };
      const auto is = [&](const CustomForce::Law& law) {
        return !p.branches() || p.is(law, one->first, two->first);
      };
      if (is_zero(splines, [&](double at) { return std::abs(energy(at)) + std::abs(swapped(at)); }) &&
          is([](double) { return Expression::Rough{}; }))
        continue;
      const auto spline = recognize_spline(splines, energy);
      if (!spline || !is([&](double at) { return rough_value(*spline, at); }))
        r.force.refuse(
            "calls a Continuous1DFunction, and has an energy between two atoms that is no multiple of one of "
            "r");
      if (!recognize_spline({{"", spline}}, swapped)) r.force.refuse(kNotMutual);
      if (cut && x.cutoff < spline->last() * (1 - 1e-12))
        r.force.refuse(
            fmt::format("is cut off at {} nm, before its function {} ends, at {} nm: let both end alike",
                        x.cutoff, spline->name(), spline->last()));
      to.potentials.push_back({one->second, two->second, spline});
    }
  if (to.potentials.empty())
    r.force.refuse("calls a Continuous1DFunction, and has no energy between any two atoms");
  read_list(r.force, to.exclusions, r.system.atoms());
  if (const double jump = largest_jump(to); jump > 1e-3)
    r.to.notes.push_back(fmt::format("jumps by {:.3g} kJ/mol where a table ends", jump));
  r.to.notes.emplace_back("is zero nearer than its tables begin, where taut stops");
}

}  // namespace

void read_custom_nonbonded(const ForceReading& r) {
  CustomNonbondedXml x;
  r.read(x.fields());
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "EnergyParameterDerivatives", "Particles",
                       "Exclusions", "Functions", "InteractionGroups"},
                      {"ComputedValues"});  // from version 3 on
  refuse_any(r.force, {"EnergyParameterDerivatives", "ComputedValues"});
  r.check_count(r.force.part("Particles"));
  r.to.periodic_pairs = x.method == NonbondedXml::kCutoffPeriodic;
  Splines splines;
  CustomForce p(r, {"PerParticleParameters", {{"r", 0}}, true}, x.energy, read_functions(r.force, splines));
  const KnownEnergy& beads = known().front();  // or the same with its end written into it
  const KnownEnergy ended{"step(1.122462048309373*sigma-r)*u;u=" + beads.text, beads.parameters};
  if (splines.empty() && p.recognize({beads, ended}) >= 0) return read_wca(r, p, x);
  refuse_any(r.force, {"InteractionGroups"});
  splines.empty() ? read_lennard_jones(r, p, x) : read_tabulated(r, p, x, splines);
}

}  // namespace taut
