#include "systems/builders/repulsive_pairs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace taut {
namespace {

struct Numbers {
  double sigma = 0, epsilon = 0;  // [nm], [kJ/mol]

  double cutoff() const { return std::pow(2.0, 1.0 / 6) * sigma; }
  bool operator==(const Numbers& other) const {
    constexpr double kRounding = 1e-12;
    return std::abs(sigma - other.sigma) <= kRounding * sigma &&
           std::abs(epsilon - other.epsilon) <= kRounding * epsilon;
  }
};

// The kinds of atoms that have an ε, and what acts between two of them.
class Kinds {
 public:
  explicit Kinds(const Nonbonded& pairs) : pairs_(pairs) {
    std::map<std::pair<double, double>, int> known;
    for (int a = 0; a < static_cast<int>(pairs.epsilon.size()); ++a) {
      const auto& table = pairs.lj_table;
      const bool has = table ? table->b.col(table->type[a]).any() : pairs.epsilon[a] > 0;
      const std::pair<double, double> key = table ? std::pair(static_cast<double>(table->type[a]), 0.0)
                                                  : std::pair(pairs.sigma[a], pairs.epsilon[a]);
      if (!has) {
        of_atom.push_back(-1);
        continue;
      }
      const auto [at, fresh] = known.try_emplace(key, static_cast<int>(first_.size()));
      if (fresh) first_.push_back(a);
      of_atom.push_back(at->second);
    }
  }

  int count() const { return static_cast<int>(first_.size()); }
  Numbers between(int i, int j) const { return between_atoms(first_[i], first_[j]); }
  // By the rule of Lorentz and Berthelot, or of types: σ⁶ = a/b, ε = b²/4a.
  Numbers between_atoms(int i, int j) const {
    if (const auto& table = pairs_.lj_table) {
      const double a = table->a(table->type[i], table->type[j]), b = table->b(table->type[i], table->type[j]);
      return b > 0 ? Numbers{std::pow(a / b, 1.0 / 6), b * b / (4 * a)} : Numbers{};
    }
    const double one = pairs_.epsilon[i], two = pairs_.epsilon[j];
    return {(pairs_.sigma[i] + pairs_.sigma[j]) / 2, one == two ? one : std::sqrt(one * two)};
  }
  bool alike() const {
    for (int i = 0; i < count(); ++i)
      for (int j = 0; j <= i; ++j)
        if (!(between(i, j) == between(0, 0))) return false;
    return true;
  }

  std::vector<int> of_atom;  // −1: none

 private:
  const Nonbonded& pairs_;
  std::vector<int> first_;  // atom of each kind
};

// From half σ, where E is 16,000 ε, to where E ends, and a few points of zero more: the spline's ends are then no part of it.
std::shared_ptr<const Spline> table_of(const Numbers& pair, const std::string& name) {
  constexpr int kIntervals = 1000, kBeyond = 8;
  const double first = pair.sigma / 2, step = (pair.cutoff() - first) / kIntervals;
  std::vector<double> energies;
  for (int k = 0; k < kIntervals; ++k) {
    const double s6 = std::pow(pair.sigma / (first + k * step), 6);
    energies.push_back(pair.epsilon * (4 * (s6 * s6 - s6) + 1));
  }
  energies.resize(kIntervals + kBeyond + 1, 0.0);
  return std::make_shared<const Spline>(name, first, pair.cutoff() + kBeyond * step, std::move(energies));
}

TabulatedPairs tables_of(const Kinds& kinds) {
  TabulatedPairs tables{kinds.of_atom, {}, {}};
  for (int i = 0; i < kinds.count(); ++i)
    for (int j = 0; j <= i; ++j)
      if (const Numbers pair = kinds.between(i, j); pair.epsilon > 0)
        tables.potentials.push_back({i, j,
                                     table_of(pair, fmt::format("of wca, sigma {:g} nm, epsilon {:g} kJ/mol",
                                                                pair.sigma, pair.epsilon))});
  return tables;
}

}  // namespace

// Atoms without an ε, as the points that carry the mass of a rigid body, have no pair force and take no part.
void make_repulsive(const TomlTable& forcefield, Terms& terms) {
  if (terms.tabulated_pairs)
    forcefield.fail("pair",
                    "wca is of pairs with a sigma and an epsilon, and a [[pair]] has a table: take "
                    "lennard-jones, or give the others tables, too");
  Nonbonded& pairs = *terms.nonbonded;
  const Kinds kinds(pairs);
  if (kinds.count() == 0) forcefield.fail("pair", "wca repels by epsilon_kj_mol, which no atom has");
  std::vector<std::array<int, 2>> exclusions;
  for (PairException& pair : pairs.exceptions) {
    const double whole = kinds.between_atoms(pair.i, pair.j).epsilon;
    if (pair.epsilon != 0 && std::abs(pair.epsilon - whole) > 1e-9 * whole)
      forcefield.fail("pair",
                      "of wca pairs three bonds apart have all or nothing: lennard_jones_14 = 0 or 1");
    if (pair.epsilon == 0) exclusions.push_back({pair.i, pair.j});
    pair.epsilon = 0;
  }
  if (kinds.alike()) {
    const auto [sigma, epsilon] = kinds.between(0, 0);
    Wca& wca = terms.wca.emplace(Wca{sigma, epsilon, std::move(exclusions)});
    for (int a = 0; a < std::ssize(kinds.of_atom); ++a)
      if (kinds.of_atom[a] < 0) wca.without.push_back(a);
  } else {
    terms.tabulated_pairs = tables_of(kinds);
    terms.tabulated_pairs->exclusions = std::move(exclusions);
  }
  pairs.epsilon.setZero();
  pairs.lj_table.reset();
  if (pairs.charge.isZero(0)) terms.nonbonded.reset();
}

}  // namespace taut
