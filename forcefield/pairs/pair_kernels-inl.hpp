// The kernels in one precision, TAUT_PAIR_REAL: included once by the source file of each.
#include <algorithm>
#include <utility>

#include "forcefield/pairs/pair_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pairs/pair_kernels-inl.hpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/pairs/dense_rows-inl.hpp"
#include "forcefield/pairs/pair_law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Rows of one kind against their clusters.
template <class T, Choice choice>
class RowSum {
  friend class PackedPairs<T, choice>;
  using S = Shape<T>;
  using D = typename S::D;
  using V = typename S::V;
  using DX = typename S::DX;
  using VX = typename S::VX;
  using Law = LawInLanes<T, choice>;
  static constexpr int kVectors = S::kVectors, kParts = S::kParts, kLanes = S::kLanes;
  static constexpr int kPlaces = kVectors * kParts;  // vectors a cluster

 public:
  HWY_INLINE RowSum(const PairLaw& law, const PairAtoms<T>& atoms, T* f)
      : x_of_(atoms.x.data()),
        inv_unit_(1 / atoms.unit),
        f_(f),
        law_(law, atoms),
        cutoff2_(set(law.cutoff * law.cutoff)),
        unit2_(set(atoms.unit * atoms.unit)) {
    for (V& sum : sum_) sum = set(0);
  }

  HWY_INLINE void add(const PairRow& row, const ClusterList& list) {
    load(row);
    for (int k = row.masked_begin; k < row.masked_end; ++k) {
      mask_ = list.masked[k].mask;
      meet(list.masked[k].cluster);
    }
    mask_ = ~0u;
    const int* clusters = list.clusters.data();
    int k = row.begin;
    if constexpr (kStaged) {
      if (k < row.end) meet_staged(clusters + k, clusters + row.end);
    } else {
      for (; k < row.end; ++k) meet(clusters[k]);
    }
    if constexpr (choice.sums()) {
      for (int i = 0; i < kSums; ++i) {
        total_[i] += double(hn::GetLane(hn::SumOfLanes(D(), sum_[i])));
        sum_[i] = set(0);
      }
    } else {
      store(row);
    }
  }

  const SixSums& total() const { return total_; }

 private:
  static HWY_INLINE V set(double value) { return hn::Set(D(), static_cast<T>(value)); }

  HWY_INLINE void load(const PairRow& row) {
    const D d;
    load_row<T>(x_of_, inv_unit_, row, x_);
    for (int v = 0; v < kVectors; ++v) {
      law_.load(row.first + v * S::kRows, atoms_[v]);
      for (int k = 0; k < 3; ++k) own_f_[k][v] = hn::Zero(d);
    }
  }

  // The row against a cluster: separations with the guess the law starts from, then the law, then forces or
  // sums.
  struct Distances {
    V r[kPlaces][3], r2[kPlaces][1], guess[kPlaces][1];
  };
  struct LawValues {
    V of[kPlaces][1];
  };

  // What comes of a cluster waits for its distances longer than the processor can look ahead: so those of the
  // next one are found before and, where registers hold so much, inverses between.
  static constexpr bool kStaged = !choice.sums() && kLanes > 1 && !choice.fine;
  static constexpr int kAhead = kPlaces == 1 ? 2 : 1;  // clusters
  HWY_INLINE void meet_staged(const int* cluster, const int* end) {
    Distances at, next, last;
    measure(*cluster, at);
    if constexpr (kAhead == 2) {
      invert(at);
      if (cluster + 1 < end) measure(cluster[1], next);
    }
    for (; cluster + kAhead < end; ++cluster) {
      measure(cluster[kAhead], last);
      invert(kAhead == 2 ? next : at);
      finish(*cluster, at);
      at = kAhead == 2 ? next : last;
      next = last;
    }
    if constexpr (kAhead == 1) invert(at);
    finish(*cluster, at);
    if (kAhead == 1 || ++cluster == end) return;
    invert(next);
    finish(*cluster, next);
  }
  HWY_INLINE void finish(int cluster, Distances& at) {
    LawValues terms;
    apply_law(cluster, at, terms);
    add_forces(cluster, at, terms);
  }

  HWY_INLINE void meet(int cluster) {
    Distances at;
    LawValues terms;
    measure(cluster, at);
    invert(at);
    apply_law(cluster, at, terms);
    for (int place = 0; place < kPlaces; ++place) {
      V& term = terms.of[place][0];
      term = hn::IfThenElseZero(counted(mask_, place % kVectors, place / kVectors), term);
      if constexpr (choice.energy()) sum_[0] += term;
      if constexpr (choice.virial()) add_virial(at.r[place], term);
    }
    if constexpr (!choice.sums()) add_forces(cluster, at, terms);
  }

  HWY_INLINE void add_virial(const V (&r)[3], V term) {
    if constexpr (sizeof(T) == 4) term *= unit2_;
    const V f[3] = {term * r[0], term * r[1], term * r[2]};
    for (int k = 0; k < 3; ++k) sum_[k] += r[k] * f[k];
    sum_[3] += r[0] * f[1];
    sum_[4] += r[0] * f[2];
    sum_[5] += r[1] * f[2];
  }

  HWY_INLINE void subtract(std::ptrdiff_t cluster, int place, V (&r)[3]) const {
    const DX d;
    const int v = place % kVectors, part = place / kVectors;
    const auto* x = x_of_ + entry(4 * cluster, 0) + part * S::kColumns;
    for (int k = 0; k < 3; ++k) r[k] = number(x_[k][v] - load_columns(d, x + 4 * k));
  }

  HWY_INLINE void measure(int cluster, Distances& out) const {
    for (int place = 0; place < kPlaces; ++place) {
      V(&r)[3] = out.r[place];
      subtract(cluster, place, r);
      V r2 = square(r);
      if constexpr (sizeof(T) == 4) r2 *= unit2_;
      out.r2[place][0] = r2;
      out.guess[place][0] = Law::guess(r2);
    }
  }

  HWY_INLINE void invert(Distances& at) const {
    for (int place = 0; place < kPlaces; ++place) Law::template invert<1>(at.r2[place], at.guess[place]);
  }

  HWY_INLINE void apply_law(std::ptrdiff_t cluster, Distances& at, LawValues& out) const {
    for (int place = 0; place < kPlaces; ++place) {
      const int v = place % kVectors, part = place / kVectors;
      const V(&r2)[1] = at.r2[place];
      V(&term)[1] = out.of[place];
      law_.template pairs<1>(atoms_[v], {4 * cluster + part * S::kColumns}, r2, at.guess[place], term);
      term[0] = hn::IfThenZeroElse(r2[0] > cutoff2_, term[0]);  // NaN must show
    }
  }

  HWY_INLINE void add_forces(std::ptrdiff_t cluster, const Distances& at, const LawValues& terms) {
    const D d;
    for (int place = 0; place < kPlaces; ++place) {
      const int v = place % kVectors, part = place / kVectors;
      const V(&r)[3] = at.r[place];
      const V term = terms.of[place][0];
      T* f = f_ + (3 * cluster * kParts + part) * kLanes;
      for (int i = 0; i < 3; ++i) own_f_[i][v] += term * r[i];
      for (int i = 0; i < 3; ++i, f += kParts * kLanes) hn::Store(hn::Load(d, f) - term * r[i], d, f);
    }
  }

  static HWY_INLINE V number(VX difference) {
    if constexpr (sizeof(T) == 4)
      return hn::ConvertTo(D(), difference);
    else
      return difference;
  }

  // Bits 4i + j of the row's atoms i in vector v and of the cluster's part.
  static HWY_INLINE auto counted(std::uint32_t mask, int v, int part) {
    std::uint8_t bytes[8] = {};
    std::uint32_t bits = mask >> (4 * v * S::kRows);
    if constexpr (S::kColumns < 4) bits = (bits >> (part * S::kColumns)) & ((1u << S::kColumns) - 1);
    bytes[0] = static_cast<std::uint8_t>(bits);
    bytes[1] = static_cast<std::uint8_t>(bits >> 8);
    return hn::LoadMaskBits(D(), bytes);
  }

  // The row's own forces go to lanes of its atoms: any copy will do. (Bits put together in memory byte by
  // byte would make the load of them all wait.)
  HWY_INLINE void store(const PairRow& row) {
    const D d;
    constexpr std::uint64_t diagonal = [] {
      std::uint64_t bits = 0;
      for (int i = 0; i < S::kRows; ++i) bits |= std::uint64_t{1} << i * (S::kColumns + 1);
      return bits;
    }();
    const int cluster = row.first / kClusterAtoms;
    for (int v = 0; v < kVectors; ++v) {
      const int at = row.first % kClusterAtoms + v * S::kRows;
      const std::uint64_t bits = diagonal << at % S::kColumns;
      const auto own = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
      T* f = f_ + (3 * cluster * kParts + at / S::kColumns % kParts) * kLanes;
      for (int k = 0; k < 3; ++k) {
        hn::Store(hn::Load(d, f) + hn::IfThenElseZero(own, sum_columns(d, own_f_[k][v])), d, f);
        f += kParts * kLanes;
      }
    }
  }

  const typename S::Coordinate* HWY_RESTRICT x_of_;
  double inv_unit_;
  T* HWY_RESTRICT f_;
  Law law_;
  V cutoff2_, unit2_;
  static constexpr int kSums = choice.virial() ? 6 : 1;  // the energy, or the virial
  V sum_[kSums];
  SixSums total_{};
  std::uint32_t mask_ = 0;  // of pairs that count
  VX x_[3][kVectors];
  V own_f_[3][kVectors];
  typename Law::Atoms atoms_[kVectors];
};

// Some rows of a pair list, and the law of their pairs.
struct ListPart {
  const PairLaw& law;
  const ClusterList& list;
  std::size_t begin, end;
};

// The kernels that there are, in the order of their turns. Those of energy and virial, which few steps ask for, take rows
// of all kinds and every form of the law.
template <class T>
constexpr auto kChoices = [] {
  struct {
    Choice all[32];
    std::size_t count = 0;
  } out;
  const auto add = [&](Choice choice) {
    if (choice.fine && !choice.sums() && !ScreeningIntervals<typename Shape<T>::D>::kMany) return;
    out.all[out.count++] = choice;
  };
  constexpr Mixing mixings[] = {Mixing::kOneSigma, Mixing::kTable, Mixing::kTwoSigmas};
  for (const bool fine : {false, true}) add({.charge = true, .fine = fine});
  for (const Mixing mixing : mixings)
    for (const bool switched : {false, true}) add({.lj = true, .mixing = mixing, .switched = switched});
  for (const Mixing mixing : mixings)
    for (const bool fine : {false, true})
      for (const bool switched : {false, true})
        add({.lj = true, .charge = true, .mixing = mixing, .switched = switched, .fine = fine});
  for (const Ask ask : {Ask::kEnergy, Ask::kVirial})
    for (const Mixing mixing : mixings)
      add({.lj = true, .charge = true, .mixing = mixing, .ask = ask, .switched = true, .fine = true});
  return out;
}();

// Whether a law asks for a kernel.
template <class T>
bool fits(const Choice& choice, const PairLaw& law, Ask ask) {
  if (choice.ask != ask || (!choice.one_sigma() && choice.mixing != law.mixing)) return false;
  if (choice.sums()) return true;
  const bool fine = ScreeningIntervals<typename Shape<T>::D>::fine(law.screening.force);
  return (!choice.lj || (law.lj && choice.switched == law.switched())) &&
         (!choice.charge || (law.charge && choice.fine == fine));
}

template <Choice choice>
bool chosen(const PairRow& row) {
  if (((row.kind & kHasOtherType) == 0) != choice.one_sigma()) return false;
  if (choice.sums()) return true;
  return (row.kind & ~kHasOtherType) == ((choice.lj ? kHasLj : 0) | (choice.charge ? kHasCharge : 0));
}

template <Choice choice>
HWY_INLINE void add_chosen(const ListPart& part, auto& sum) {
  for (std::size_t r = part.begin; r < part.end; ++r)
    if (chosen<choice>(part.list.rows[r])) sum.add(part.list.rows[r], part.list);
}

template <class T, Choice choice>
HWY_NOINLINE SixSums sum_rows(const ListPart& part, const PairAtoms<T>& atoms, T* f) {
  RowSum<T, choice> sum(part.law, atoms, f);
  if constexpr (kPacksPairs<T, choice>) {
    PackedPairs<T, choice> dense(part.law, atoms.unit, sum);
    add_chosen<choice>(part, dense);
    dense.add_forces();
  } else {
    add_chosen<choice>(part, sum);
  }
  return sum.total();
}

HWY_INLINE void add_to(SixSums& sum, const SixSums& part) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += part[k];
}

// Kinds take turns, so that rows near each other find the same clusters still in the cache.
template <class T>
SixSums sum_all(Ask ask, const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, T* f) {
  constexpr std::size_t kTurn = 256;  // rows
  SixSums sum{};
  for (std::size_t begin = 0; begin < list.rows.size(); begin += kTurn) {
    const ListPart part{law, list, begin, std::min(begin + kTurn, list.rows.size())};
    const auto take_turn = [&]<Choice choice>() {
      if (fits<T>(choice, law, ask)) add_to(sum, sum_rows<T, choice>(part, atoms, f));
    };
    const auto take_turns = [&]<std::size_t... n>(std::index_sequence<n...>) {
      (take_turn.template operator()<kChoices<T>.all[n]>(), ...);
    };
    take_turns(std::make_index_sequence<kChoices<T>.count>());
  }
  return sum;
}

using Real = TAUT_PAIR_REAL;

void forces(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list, Real* f) {
  sum_all(Ask::kForces, law, atoms, list, f);
}
double energy(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list) {
  return sum_all<Real>(Ask::kEnergy, law, atoms, list, nullptr)[0];
}
SixSums virial(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list) {
  return sum_all<Real>(Ask::kVirial, law, atoms, list, nullptr);
}
int copies(const Real*) {
  return Shape<Real>::kRows;
}
ScreeningFit fit(const Real*) {
  return ScreeningIntervals<Shape<Real>::D>::fit();
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

using Real = TAUT_PAIR_REAL;

HWY_EXPORT(forces);
HWY_EXPORT(energy);
HWY_EXPORT(virial);
HWY_EXPORT(copies);
HWY_EXPORT(fit);

template <>
int force_copies<Real>() {
  return HWY_DYNAMIC_DISPATCH(copies)(nullptr);
}
template <>
ScreeningFit screening_fit<Real>() {
  return HWY_DYNAMIC_DISPATCH(fit)(nullptr);
}
template <>
void add_pair_forces(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list, Real* f) {
  HWY_DYNAMIC_DISPATCH(forces)(law, atoms, list, f);
}
template <>
double pair_energy(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(energy)(law, atoms, list);
}
template <>
SixSums pair_virial(const PairLaw& law, const PairAtoms<Real>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(virial)(law, atoms, list);
}

}  // namespace taut
#endif
