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
#include "systems/openmm/pair_energy.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

constexpr std::size_t kMostTypes = 500;
// CHARMM's force switch is an energy of its own.
constexpr const char* kRemedy = "; to switch Lennard-Jones off give the force a switchingDistance";

const std::vector<KnownEnergy>& known() {
  static const std::vector<KnownEnergy> kAll = {
      {kWcaEnergy, {{"sigma"}, {"epsilon"}}, "1.122462048309373*sigma-r"},
      {kLennardJonesEnergy, {}},  // these are known by their values, below
      {kCutPairsEnergy, {}}};
  return kAll;
}

double largest_jump(const TabulatedPairs& pairs) {
  double most = 0;
  for (const auto& potential : pairs.potentials)
    most = std::max(most, std::abs(potential.energy->values().back()));
  return most;
}

constexpr double kFarther = std::numeric_limits<double>::infinity();
constexpr double kAnything = std::numeric_limits<double>::max() / 8;

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

// The energy of each pair of types.
class PairsOfTypes {
 public:
  PairsOfTypes(const ForceReading& r, const CustomForce& p, AtomTypes types, std::optional<double> reach)
      : r_(r), p_(p), types_(std::move(types)), reach_(reach), laws_(types_.size() * types_.size()) {
    for (const auto& one : types_)
      for (const auto& two : types_) {
        const auto law =
            PairEnergy::of([&](double at) { return p.pair_energy(one.first, two.first, at); }, reach);
        const auto within_reach = [&](double at) {  // beyond it anything is right
          return at < reach.value_or(kFarther) ? law->at(at) : Expression::Rough{0, kAnything};
        };
        if (!law || (p.branches() && !p.is(within_reach, one.first, two.first))) refuse();
        at(one.second, two.second) = *law;
      }
  }

  void read(Nonbonded& to) {
    const auto n = static_cast<Eigen::Index>(types_.size());
    LennardJonesTable& table = *to.lj_table;
    table.a = table.b = Eigen::MatrixXd::Zero(n, n);
    bool charged = false;
    for_each([&](int i, int j, const PairEnergy& law) {
      const PairEnergy& back = at(j, i);
      const auto even = [](double x, double y) { return std::abs(x - y) <= 1e-11 * std::abs(x); };
      if (!even(law.a, back.a) || !even(law.b, back.b) || !even(law.q, back.q)) r_.force.refuse(kNotMutual);
      table.a(i, j) = law.a;
      table.b(i, j) = law.b;
      charged |= law.q != 0;
    });
    if (charged) read_charges(to);
    read_ends(to);
  }

 private:
  [[noreturn]] void refuse() const { p_.refuse_energy(known(), kRemedy); }
  PairEnergy& at(int i, int j) { return laws_[static_cast<std::size_t>(i) * types_.size() + j]; }
  void for_each(const auto& use) {
    for (int i = 0; i < std::ssize(types_); ++i)
      for (int j = 0; j < std::ssize(types_); ++j) use(i, j, at(i, j));
  }

  // Charges are the parameter of the atoms that q is a product of.
  void read_charges(Nonbonded& to) {
    const auto parameters = static_cast<std::size_t>(std::ssize(types_.begin()->first));
    for (std::size_t p = 0; p < parameters; ++p) {
      std::vector<double> charge(types_.size());
      for (const auto& [numbers, type] : types_) charge[static_cast<std::size_t>(type)] = numbers[p];
      double strength = 0, most = 0;
      for_each([&](int i, int j, const PairEnergy& law) {
        const double qq = charge[i] * charge[j];
        if (std::abs(qq) > std::abs(most)) most = qq, strength = law.q / qq;
      });
      bool all = strength > 0;
      for_each([&](int i, int j, const PairEnergy& law) {
        all = all && std::abs(law.q - strength * charge[i] * charge[j]) <= 1e-9 * strength * std::abs(most);
      });
      if (!all) continue;
      to.dielectric = kCoulomb / strength;
      to.charge.resize(std::ssize(to.lj_table->type));
      for (Eigen::Index a = 0; a < to.charge.size(); ++a) to.charge[a] = charge[to.lj_table->type[a]];
      return read_field(to);
    }
    refuse();
  }

  // k = k_rf q, and k_rf says the dielectric constant beyond the cutoff; infinity where that is rounding error.
  void read_field(Nonbonded& to) {
    const PairEnergy& strongest =
        *std::ranges::max_element(laws_, {}, [](const PairEnergy& law) { return std::abs(law.q); });
    const double k_rf = strongest.k / strongest.q;
    for_each([&](int, int, const PairEnergy& law) {
      if (!(std::abs(law.k - k_rf * law.q) <= 1e-9 * std::abs(strongest.k))) refuse();
    });
    if (!reach_) return k_rf == 0 ? void() : refuse();
    const double ratio = k_rf * std::pow(*reach_, 3), rest = 1 - 2 * ratio;  // (ε − 1)/(2ε + 1)
    if (!(ratio >= -1e-9 && rest >= -1e-9)) refuse();
    to.rf_dielectric = rest < 1e-9 ? kFarther : std::max(1.0, (1 + ratio) / rest);
  }

  // What energies end with: charges at zero, Lennard-Jones as it is or at zero, too.
  void read_ends(Nonbonded& to) {
    const double u = reach_ ? std::pow(*reach_, -6) : 0;
    const double c_rf = reach_ && to.charge.size() > 0 ? to.reaction_field().c : 0;
    bool plain = true, shifted = reach_.has_value();
    for_each([&](int, int, const PairEnergy& law) {
      const double of_field = -c_rf * law.q, to_zero = -(law.a * u - law.b) * u;
      const double slack =
          1e-9 * (std::abs(of_field) + (std::abs(law.a) * u + std::abs(law.b)) * u + std::abs(law.e));
      plain = plain && std::abs(law.e - of_field) <= slack;
      shifted = shifted && std::abs(law.e - of_field - to_zero) <= slack;
      if (to.charge.size() == 0 && law.k != 0) refuse();
    });
    if (!plain && !shifted) refuse();
    to.shifted = !plain;
  }

  const ForceReading& r_;
  const CustomForce& p_;
  AtomTypes types_;
  std::optional<double> reach_;
  std::vector<PairEnergy> laws_;
};

void read_lennard_jones(const ForceReading& r, CustomForce& p, const CustomNonbondedXml& x) {
  Nonbonded& lj = r.to.lennard_jones.emplace();
  if (x.method != NonbondedXml::kNoCutoff) lj.cutoff = x.cutoff;
  AtomTypes types = read_types(r, p, lj.lj_table.emplace().type);
  PairsOfTypes(r, p, std::move(types), lj.cutoff).read(lj);
  std::vector<std::array<int, 2>> exclusions;
  read_list(r.force, exclusions, r.system.atoms());
  for (const auto& [i, j] : exclusions) lj.exceptions.push_back({i, j, 0, 1, 0});
  lj.dispersion_correction = x.corrected && *r.to.periodic_pairs;
  if (x.switched && lj.cutoff) lj.switch_distance = x.switch_distance;
  if (lj.charge.size() == 0 && !lj.shifted) return;
  if (lj.switch_distance)
    r.force.refuse(
        "has useSwitchingFunction=\"1\": taut switches Lennard-Jones alone, where it is not shifted");
  if (lj.dispersion_correction)
    r.force.refuse(
        "has useLongRangeCorrection=\"1\": taut corrects Lennard-Jones alone, where it is not shifted");
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
