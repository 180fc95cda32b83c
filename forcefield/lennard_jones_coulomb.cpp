#include "forcefield/lennard_jones_coulomb.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "forcefield/exceptions.hpp"
#include "forcefield/pair_sum.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBufferShare = 0.11;  // of the cutoff: 0.1 nm at 0.9 nm

inline PairTerm lennard_jones(double sigma, double four_epsilon, double inv_r2) {
  const double s2 = sigma * sigma * inv_r2, s6 = s2 * s2 * s2;
  return {four_epsilon * (s6 - 1) * s6, four_epsilon * (12 * s6 - 6) * s6 * inv_r2};
}

// E S: the force gains −E S'/r.
inline PairTerm switched_off(const PairTerm& p, double r, double rs, double rc) {
  const double inv_width = 1 / (rc - rs), x = (r - rs) * inv_width;
  const double S = 1 + x * x * x * (-10 + x * (15 - 6 * x));
  const double dS_dr = x * x * (-30 + x * (60 - 30 * x)) * inv_width;
  return {p.energy * S, p.force_over_r * S - p.energy * dS_dr / r};
}

// The pair law of PairSum for pairs with Lennard-Jones, charges, or both.
template <bool kLj, bool kCharge, bool kSwitched>
class Law {
 public:
  Law(const std::vector<LennardJonesCoulomb::Atom>& atoms, const LennardJonesCoulomb::Numbers& numbers)
      : atoms_(atoms.data()), n_(numbers) {}

  void row(int i) { a_ = atoms_[i]; }

  void load(int k, int j) {
    const auto& b = atoms_[j];
    if constexpr (kCharge) kqq_[k] = a_.charge * b.charge;
    if constexpr (kLj) {
      sigma_[k] = a_.half_sigma + b.half_sigma;
      four_epsilon_[k] = a_.two_sqrt_epsilon * b.two_sqrt_epsilon;
    }
  }

  PairTerm operator()(int k, double r2) const {
    const double inv_r2 = 1 / r2;
    PairTerm pair{0, 0};
    if constexpr (kLj) {
      pair = lennard_jones(sigma_[k], four_epsilon_[k], inv_r2);
      if constexpr (kSwitched)
        if (r2 > n_.switch_distance * n_.switch_distance)
          pair = switched_off(pair, std::sqrt(r2), n_.switch_distance, n_.cutoff);
    }
    if constexpr (kCharge) {
      const double inv_r = std::sqrt(inv_r2);
      pair.energy += kqq_[k] * (inv_r + n_.k_rf * r2 - n_.c_rf);
      pair.force_over_r += kqq_[k] * (inv_r * inv_r2 - 2 * n_.k_rf);
    }
    return pair;
  }

 private:
  const LennardJonesCoulomb::Atom* atoms_;
  LennardJonesCoulomb::Numbers n_;
  LennardJonesCoulomb::Atom a_;
  std::array<double, kPairBlock> kqq_, sigma_, four_epsilon_;
};

}  // namespace

PairRules LennardJonesCoulomb::rules(const Nonbonded& nb) {
  PairRules rules;
  for (Eigen::Index i = 0; i < nb.charge.size(); ++i) {
    const int kind = (nb.epsilon[i] != 0 ? kLj : 0) | (nb.charge[i] != 0 ? kCharge : 0);
    rules.kind.push_back(static_cast<std::uint8_t>(kind));
  }
  for (const auto& e : nb.exceptions) rules.exclusions.push_back({e.i, e.j});
  return rules;
}

LennardJonesCoulomb::LennardJonesCoulomb(const Nonbonded& nb, const Box& box)
    : exceptions_(interacting(nb.exceptions)),
      box_(box),
      numbers_{nb.cutoff.value_or(kInfinity), nb.switch_distance.value_or(kInfinity)},
      sorter_(rules(nb)) {
  for (Eigen::Index i = 0; i < nb.charge.size(); ++i)
    atoms_.push_back({std::sqrt(kCoulomb) * nb.charge[i], 0.5 * nb.sigma[i], 2 * std::sqrt(nb.epsilon[i])});
  if (nb.cutoff) {
    const double rc = *nb.cutoff, eps = nb.rf_dielectric;
    numbers_.k_rf = (eps - 1) / ((2 * eps + 1) * rc * rc * rc);
    numbers_.c_rf = 3 * eps / ((2 * eps + 1) * rc);
    list_.emplace(rules(nb), box, ListRange{rc, kBufferShare * rc});
  } else {
    everyone_.resize(atoms_.size());
    std::iota(everyone_.begin(), everyone_.end(), 0);
  }
}

double LennardJonesCoulomb::add(const Vectors& x, Vectors& f) {
  if (!list_) return add_all(x, f) + add_exceptions(exceptions_, x, f);
  list_->update(x);
  return add_listed(list_->pairs(), list_->positions(), f) + add_exceptions(exceptions_, x, f);
}

double LennardJonesCoulomb::add_all(const Vectors& x, Vectors& f) {
  double energy = 0;
  const int n = static_cast<int>(everyone_.size());
  for (int i = 0; i < n; ++i) {
    if (!sorter_.interacts(i)) continue;
    for (auto& list : row_) list.clear();
    sorter_.add_row({i, everyone_.data() + i + 1, n - i - 1}, row_);
    energy += add_listed(row_, x, f);
  }
  return energy;
}

double LennardJonesCoulomb::add_listed(const PairLists& lists, const Vectors& x, Vectors& f) const {
  return add_kind<kLj>(lists[kLj], x, f) + add_kind<kCharge>(lists[kCharge], x, f) +
         add_kind<kBoth>(lists[kBoth], x, f);
}

template <int kind>
double LennardJonesCoulomb::add_kind(const PairList& list, const Vectors& x, Vectors& f) const {
  constexpr bool lj = kind & kLj, charge = kind & kCharge;
  if (list.rows.empty()) return 0;
  if (lj && numbers_.switch_distance < numbers_.cutoff)
    return add_law(Law<lj, charge, true>(atoms_, numbers_), list, x, f);
  return add_law(Law<lj, charge, false>(atoms_, numbers_), list, x, f);
}

template <class Law>
double LennardJonesCoulomb::add_law(Law law, const PairList& list, const Vectors& x, Vectors& f) const {
  return list_ && list_->needs_images() ? PairSum<true>(box_, numbers_.cutoff).add(list, law, x, f)
                                        : PairSum<false>(box_, numbers_.cutoff).add(list, law, x, f);
}

}  // namespace taut
