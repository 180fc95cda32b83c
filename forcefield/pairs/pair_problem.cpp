#include "forcefield/pairs/pair_problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace taut {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Finds the usual type, that of most Lennard-Jones atoms, where `type` has each atom's, and marks the others.
// Returns the first atom of the usual type; −1 where there is no Lennard-Jones.
int add_kinds(PairProblem& p, const auto& type) {
  const int n = static_cast<int>(p.charge.size());
  std::map<double, std::pair<int, int>> atoms_of;  // number of atoms, the first one
  for (int i = 0; i < n; ++i)
    if (p.two_sqrt_epsilon[i] != 0) ++atoms_of.try_emplace(type[i], 0, i).first->second.first;
  const auto usual = std::ranges::max_element(atoms_of, {}, [](const auto& of) { return of.second.first; });
  for (int i = 0; i < n; ++i) {
    const bool lj = p.two_sqrt_epsilon[i] != 0, charge = p.charge[i] != 0;
    p.kind.push_back(static_cast<std::uint8_t>((lj ? kHasLj : 0) | (charge ? kHasCharge : 0) |
                                               (lj && type[i] != usual->first ? kHasOtherType : 0)));
    p.law.lj |= lj;
    p.law.charge |= charge;
  }
  if (atoms_of.size() < 2) p.law.mixing = Mixing::kOneSigma;
  return atoms_of.empty() ? -1 : usual->second.second;
}

void add_kinds_by_sigma(PairProblem& p) {
  const int usual = add_kinds(p, p.half_sigma);
  p.law.sigma = usual < 0 ? 0 : 2 * p.half_sigma[usual];
}

// The usual type's pairs take no table: σ⁶ = a/b and 4ε = b²/a.
void add_kinds_by_table(const LennardJonesTable& from, PairProblem& p) {
  const int usual = add_kinds(p, from.type);
  p.law.mixing = Mixing::kTable;
  if (usual < 0) return;
  const int type = from.type[usual];
  const double a = from.a(type, type), b = from.b(type, type);
  if (!(a > 0 && b > 0)) {
    for (auto& kind : p.kind)
      if ((kind & kHasLj) != 0) kind |= kHasOtherType;
    return;
  }
  p.law.sigma = std::pow(a / b, 1.0 / 6);
  for (Eigen::Index i = 0; i < p.two_sqrt_epsilon.size(); ++i)
    if (from.type[i] == type) p.two_sqrt_epsilon[i] = b / std::sqrt(a);
}

// With a table two_sqrt_epsilon only tells whether an atom has Lennard-Jones, but for the usual type: 1, or 0 where
// its type has none.
void take_table(const LennardJonesTable& from, PairProblem& p) {
  const Eigen::Index n = from.a.rows();
  p.table = {from.type, Eigen::MatrixXd::Zero(n + 1, n + 1), Eigen::MatrixXd::Zero(n + 1, n + 1)};
  p.table.a.topLeftCorner(n, n) = from.a;
  p.table.b.topLeftCorner(n, n) = from.b;
  p.law.types = static_cast<double>(n + 1);
  for (Eigen::Index i = 0; i < p.two_sqrt_epsilon.size(); ++i)
    p.two_sqrt_epsilon[i] = from.a.col(from.type[i]).any() || from.b.col(from.type[i]).any() ? 1 : 0;
}

// In units of the cutoff: wider ones make lists more rarely but add pairs beyond the cutoff.
struct Buffers {
  double way, spare, outer;
};
// Hardly any cluster of the core leaves the cutoff during the life of an outer list. As the cutoff is at most half
// the shortest edge of the box, cutoff and outer buffer together stay below one edge.
void choose_buffers(PairProblem& p, const Buffers& in_cutoffs) {
  p.way = in_cutoffs.way * p.law.cutoff;
  p.spare = in_cutoffs.spare * p.law.cutoff;
  p.outer = in_cutoffs.outer * p.law.cutoff;
  p.core = 0.97 * p.law.cutoff;
}

}  // namespace

PairProblem problem_of(const Nonbonded& nb, bool periodic, Precision precision) {
  PairProblem p;
  p.law.cutoff = nb.cutoff.value_or(kInfinity);
  p.law.switch_distance = nb.switch_distance.value_or(kInfinity);
  if (nb.cutoff) {
    const double rc = *nb.cutoff;
    if (nb.shifted) p.law.shift_inv_r6 = std::pow(rc, -6);
    if (nb.pme) {
      p.law.screening =
          Screening(nb.pme->alpha, rc,
                    precision == Precision::kDouble ? screening_fit<double>() : screening_fit<float>());
    } else {
      p.law.k_rf = nb.reaction_field().k;
      p.law.c_rf = nb.reaction_field().c;
    }
    p.periodic = periodic;  // without a cutoff there are no images
    choose_buffers(p, {.way = 0.007, .spare = 0.006, .outer = 0.54});
  }
  p.charge = std::sqrt(nb.coulomb()) * nb.charge;
  p.half_sigma = 0.5 * nb.sigma;
  p.two_sqrt_epsilon = 2 * nb.epsilon.cwiseSqrt();
  for (const auto& e : nb.exceptions) p.exclusions.push_back({e.i, e.j});
  if (nb.lj_table) {
    take_table(*nb.lj_table, p);
    add_kinds_by_table(*nb.lj_table, p);
  } else {
    add_kinds_by_sigma(p);
  }
  return p;
}

PairProblem problem_of(const Wca& wca, int atoms, bool periodic) {
  PairProblem p;
  p.law.cutoff = wca.cutoff();
  p.law.energy_shift = 1;
  p.periodic = periodic;
  choose_buffers(p, {.way = 0.01, .spare = 0.008, .outer = 0.5});
  p.charge = Eigen::VectorXd::Zero(atoms);
  p.half_sigma = Eigen::VectorXd::Constant(atoms, wca.sigma / 2);
  p.two_sqrt_epsilon = Eigen::VectorXd::Constant(atoms, 2 * std::sqrt(wca.epsilon));
  for (const int a : wca.without) p.two_sqrt_epsilon[a] = 0;
  p.exclusions = wca.exclusions;
  add_kinds_by_sigma(p);
  return p;
}

PairProblem problem_of(const TabulatedPairs& pairs, bool periodic) {
  const auto n = static_cast<Eigen::Index>(pairs.kind.size());
  PairProblem p;
  p.law.cutoff = pairs.cutoff();
  p.law.mixing = Mixing::kTable;
  p.periodic = periodic;
  choose_buffers(p, {.way = 0.007, .spare = 0.006, .outer = 0.54});
  p.charge = p.half_sigma = p.two_sqrt_epsilon = Eigen::VectorXd::Zero(n);
  p.exclusions = pairs.exclusions;
  p.tables = tables_by_kinds(pairs);
  p.law.types = p.tables->kinds;
  for (const int kind : pairs.kind) {
    const bool has = kind >= 0 && kind < p.tables->kinds - 1;
    p.table.type.push_back(has ? kind : p.tables->kinds - 1);
    p.kind.push_back(static_cast<std::uint8_t>(has ? kHasLj : 0));
  }
  return p;
}

AtomClusters::Layout PairProblem::layout() const {
  AtomClusters::Layout layout{periodic, law.cutoff + outer, {}, {}};
  for (const auto k : kind) {
    layout.present.push_back(k != 0);
    layout.first.push_back((k & kHasLj) != 0);
  }
  return layout;
}

}  // namespace taut
