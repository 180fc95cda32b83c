#include "systems/openmm/lennard_jones.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/errors.hpp"

namespace taut {
namespace {

using Pair = std::pair<int, int>;

std::set<Pair> pairs_of(const std::vector<PairException>& exceptions) {
  std::set<Pair> all;
  for (const auto& e : exceptions) all.insert(std::minmax(e.i, e.j));
  return all;
}

void check_same_pairs(const Nonbonded& types, const Nonbonded& charges) {
  const auto ours = pairs_of(types.exceptions), theirs = pairs_of(charges.exceptions);
  std::vector<Pair> others;
  std::set_symmetric_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                                std::back_inserter(others));
  if (others.empty()) return;
  const auto [i, j] = others.front();
  throw InputError(fmt::format("{} the pair {}-{}, the NonbondedForce does {}: taut takes the same for both",
                               ours.contains(others.front()) ? "excludes" : "does not exclude", i, j,
                               ours.contains(others.front()) ? "not" : "so"));
}

// Returns σ and ε of 4ε((σ/r)¹² − (σ/r)⁶) for each type with itself.
struct OfTypes {
  Eigen::VectorXd sigma, epsilon;

  explicit OfTypes(const LennardJonesTable& t) : sigma(t.a.rows()), epsilon(t.a.rows()) {
    for (Eigen::Index i = 0; i < sigma.size(); ++i) {
      const double a = t.a(i, i), b = t.b(i, i);
      const bool none = !(a > 0 && b > 0);
      sigma[i] = none ? 0 : std::pow(a / b, 1.0 / 6);
      epsilon[i] = none ? 0 : b * b / (4 * a);
    }
  }

  bool mix_to(const LennardJonesTable& t) const {
    const auto near = [](double x, double y) { return std::abs(x - y) <= 1e-11 * std::abs(y); };
    for (Eigen::Index i = 0; i < sigma.size(); ++i)
      for (Eigen::Index j = 0; j < sigma.size(); ++j) {
        const double s6 = std::pow((sigma[i] + sigma[j]) / 2, 6), e = std::sqrt(epsilon[i] * epsilon[j]);
        if (!near(4 * e * s6 * s6, t.a(i, j)) || !near(4 * e * s6, t.b(i, j))) return false;
      }
    return true;
  }
};

bool near(double one, double two) {
  return std::abs(one - two) <= 1e-9 * std::abs(two);
}

}  // namespace

void add_lennard_jones(Nonbonded types, std::optional<Nonbonded>& to) {
  const auto n = static_cast<Eigen::Index>(types.lj_table->type.size());
  const bool alone = !to;
  if (alone) {
    to = types;
    if (types.charge.size() == 0) to->charge.setZero(n);
    to->sigma.setZero(n);
    to->epsilon.setZero(n);
  }
  if (!alone && types.charge.size() > 0)
    throw InputError("has charges, as the NonbondedForce: taut takes them of one of the two");
  if (to->epsilon.any())
    throw InputError("adds to the Lennard-Jones of a NonbondedForce: taut takes one of the two");
  if (to->cutoff != types.cutoff)
    throw InputError(fmt::format("is cut off at {} nm, the NonbondedForce at {} nm: taut has one cutoff",
                                 types.cutoff.value_or(HUGE_VAL), to->cutoff.value_or(HUGE_VAL)));
  check_same_pairs(types, *to);
  to->switch_distance = types.switch_distance;
  to->shifted = types.shifted;
  to->dispersion_correction = types.dispersion_correction;
  const OfTypes of(*types.lj_table);
  if (!of.mix_to(*types.lj_table)) {
    to->lj_table = std::move(types.lj_table);
    return;
  }
  to->lj_table.reset();
  for (Eigen::Index a = 0; a < n; ++a) {
    to->sigma[a] = of.sigma[types.lj_table->type[a]];
    to->epsilon[a] = of.epsilon[types.lj_table->type[a]];
  }
}

void add_excluded_field(const std::vector<ExcludedCharges>& field, std::optional<Nonbonded>& to) {
  std::map<Pair, double> left;  // that the field must be between, and of [kJ/mol·nm]
  if (to) {
    const Eigen::VectorXd& q = to->charge;
    for (const auto& e : to->exceptions)
      if (const double qq = q[e.i] * q[e.j]; qq != 0) left[std::minmax(e.i, e.j)] = to->coulomb() * qq;
    for (int a = 0; a < q.size(); ++a)
      if (q[a] != 0) left[{a, a}] = to->coulomb() * q[a] * q[a] / 2;
  }
  const bool any = std::ranges::any_of(field, [](const auto& f) { return f.coulomb != 0; });
  if (!any) return;
  for (const ExcludedCharges& f : field) {
    if (f.coulomb == 0) continue;
    if (!to->cutoff || !near(f.cutoff, *to->cutoff) || !std::isinf(to->rf_dielectric))
      throw InputError(fmt::format(
          "has a reaction field of infinite dielectric constant to {} nm, another one than the pairs",
          f.cutoff));
    const auto at = left.find(std::minmax(f.i, f.j));
    if (at == left.end() || !near(f.coulomb, at->second))
      throw InputError(fmt::format(
          "has the reaction field between {} and {} with {} kJ/mol nm, expected {}: taut has it as it "
          "follows from charges and exclusions",
          f.i, f.j, f.coulomb, at == left.end() ? 0 : at->second));
    left.erase(at);
  }
  if (!left.empty())
    throw InputError(fmt::format(
        "has no reaction field between {} and {}, which exclude each other: taut has it between all "
        "such charges, and of each on itself, or nowhere",
        left.begin()->first.first, left.begin()->first.second));
  to->rf_excluded = true;
}

void add_pairs(const std::vector<PairException>& pairs, std::optional<Nonbonded>& to) {
  if (pairs.empty()) return;
  std::map<Pair, PairException*> exceptions;
  if (to)
    for (auto& e : to->exceptions) exceptions[std::minmax(e.i, e.j)] = &e;
  for (const auto& p : pairs) {
    if (p.epsilon == 0) continue;
    const auto at = exceptions.find(std::minmax(p.i, p.j));
    if (at == exceptions.end())
      throw InputError(
          fmt::format("has the pair {}-{}, which is no exception of a NonbondedForce: taut takes "
                      "one Lennard-Jones for a pair",
                      p.i, p.j));
    if (at->second->epsilon != 0)
      throw InputError(
          fmt::format("has the pair {}-{}, which has Lennard-Jones already: taut takes one for a "
                      "pair",
                      p.i, p.j));
    at->second->sigma = p.sigma;
    at->second->epsilon = p.epsilon;
  }
}

}  // namespace taut
