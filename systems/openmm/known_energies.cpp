#include "systems/openmm/known_energies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "systems/openmm/expression_functions.hpp"

namespace taut {
namespace {

using Values = Expression::Values;
using Rough = Expression::Rough;
using Ways = Expression::Ways;

// Points at which a choice of parameters is refused quickly, and the factor found.
constexpr int kTrials = 24;

class Choice {
 public:
  Choice(const Expression& energy, const std::vector<Quantity>& fixed,
         const std::vector<Quantity>& coordinates, const KnownEnergy& known)
      : energy_(energy),
        known_(known),
        known_energy_(known.text),
        where_(known.where),
        coordinates_(coordinates) {
    Random random(2);
    for (Trial& trial : trials_) {
      for (const Quantity& q : fixed) trial.given[q.name] = drawn(q, random, 10);
      for (const Quantity& q : known.parameters) trial.known[q.name] = drawn(q, random, 10);
      for (const Quantity& q : coordinates) trial.given[q.name] = trial.known[q.name] = drawn(q, random, 10);
      trial.counts = where_(trial.known) > 0;
      trial.value = known_energy_.probe(trial.known, ways_);
    }
    for (const Quantity& q : fixed) fixed_[q.name] = q;
  }

  // The factor of the given energy if names[k] stands for the k-th known parameter; 0 if it is another energy.
  double factor(const std::vector<std::string>& names) {
    std::vector<double> ratios;
    double least = -rough::kUnknown, most = rough::kUnknown;
    for (const Trial& trial : trials_) {
      if (!trial.counts || !trial.value.decided() || !std::isfinite(trial.value.value)) continue;
      Values given = trial.given;
      for (std::size_t k = 0; k < known_.parameters.size(); ++k)
        given[names[k]] = trial.known.at(known_.parameters[k].name);
      const Rough other = energy_.probe(given, ways_);
      if (!other.decided()) continue;
      if (trial.value.value == 0) {
        if (!same(other, {0, 0})) return 0;
        continue;
      }
      const double ratio = other.value / trial.value.value;
      const double error =
          4 * (other.error + std::abs(ratio) * trial.value.error) / std::abs(trial.value.value);
      if (!(error < rough::kUnknown)) continue;
      least = std::max(least, ratio - error);
      most = std::min(most, ratio + error);
      if (least > most) return 0;
      if (error < 1e-3 * std::abs(ratio)) ratios.push_back(ratio);
    }
    if (ratios.empty()) return 0;
    const auto middle = ratios.begin() + std::ssize(ratios) / 2;
    std::ranges::nth_element(ratios, middle);
    return *middle;
  }

  // Whether it is that everywhere.
  bool is(const std::vector<std::string>& names, double factor) const {
    std::map<std::string, Quantity> parameters = fixed_;
    for (std::size_t k = 0; k < names.size(); ++k) {
      parameters[names[k]] = known_.parameters[k];
      parameters[names[k]].name = names[k];
    }
    Domain domain{{}, coordinates_};
    for (const auto& [name, quantity] : parameters) domain.parameters.push_back(quantity);
    const auto as_known = [&](const Values& given) {
      Values known;
      for (std::size_t k = 0; k < names.size(); ++k) known[known_.parameters[k].name] = given.at(names[k]);
      for (const Quantity& q : coordinates_) known[q.name] = given.at(q.name);
      return known;
    };
    return agree_everywhere(energy_, domain, [&](const Values& given, Ways& ways) {
      const Values known = as_known(given);
      Rough value = known_energy_.probe(known, ways);
      if (!(where_(known) > 0)) return Rough{0, rough::kUnknown};
      value.value *= factor;
      value.error = std::abs(factor) * value.error + rough::kTenDigits * std::abs(value.value);
      return value;
    });
  }

 private:
  struct Trial {
    Values known, given;  // arguments of the known and of the given energy
    bool counts = false;  // the known energy is asked for there (KnownEnergy::where)
    Rough value;          // of the known energy
  };
  const Expression& energy_;
  const KnownEnergy& known_;
  Expression known_energy_, where_;
  const std::vector<Quantity>& coordinates_;
  std::map<std::string, Quantity> fixed_;
  std::array<Trial, kTrials> trials_;
  Ways ways_;
};

constexpr std::size_t kMostDeclared = 8;  // with more parameters than this, only equal names are tried

}  // namespace

std::optional<Recognized> recognize(const Expression& energy, std::vector<std::string> declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known) {
  std::vector<Quantity> others;
  for (const auto& name : declared) others.push_back({name});
  for (const auto& [name, value] : energy.numbers()) {
    others.push_back({name, value, value});
    declared.push_back(name);
  }
  for (const auto& name : energy.names())  // a parameter of each atom of a pair is none of them
    if (!std::ranges::count(declared, name) && !std::ranges::count(coordinates, name, &Quantity::name))
      return {};

  Choice choice(energy, others, coordinates, known);
  const std::size_t n = known.parameters.size();
  const auto compare = [&](const std::vector<std::string>& names) -> std::optional<Recognized> {
    Recognized found{choice.factor(names), {}};
    if (found.factor == 0 ||
        !choice.is({names.begin(), names.begin() + static_cast<std::ptrdiff_t>(n)}, found.factor))
      return {};
    for (std::size_t k = 0; k < n; ++k) found.name_of[known.parameters[k].name] = names[k];
    return found;
  };

  std::vector<std::string> names;
  for (const Quantity& q : known.parameters) names.push_back(q.name);
  if (std::ranges::all_of(names, [&](const auto& name) { return std::ranges::count(declared, name) > 0; }))
    if (auto found = compare(names)) return found;
  if (declared.size() > kMostDeclared || declared.size() < n) return {};
  // Every choice of n names in every order. Reversing the rest skips the orders that differ in it alone.
  names = declared;
  std::ranges::sort(names);
  do {
    if (auto found = compare(names)) return found;
    std::reverse(names.begin() + static_cast<std::ptrdiff_t>(n), names.end());
  } while (std::next_permutation(names.begin(), names.end()));
  return {};
}

}  // namespace taut
