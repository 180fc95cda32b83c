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
  static constexpr int kParts = S::kParts, kLanes = S::kLanes;

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
      if (k == row.end) {
      } else if (law_.screened()) {
        meet_staged(clusters + k, clusters + row.end, true);
      } else {
        meet_staged(clusters + k, clusters + row.end, false);
      }
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
    law_.load(row.first, atoms_);
    for (V& own : own_f_) own = hn::Zero(d);
  }

  // The row against a cluster: separations with the guess the law starts from, then the law, then forces or
  // sums.
  struct Distances {
    std::ptrdiff_t slot = 0;  // the cluster's first
    V r[kParts][3], r2[kParts][1], guess[kParts][1];
  };
  struct LawValues {
    V of[kParts][1];
  };

  // What comes of a cluster waits for its distances longer than the processor can look ahead: so those of the
  // next one are found before and, where registers (32 in AVX-512, 16 in AVX2) hold so much, inverses between.
  static constexpr bool kStaged = !choice.sums() && kLanes > 1 && !choice.fine;
  static constexpr int kAhead = HWY_TARGET <= HWY_AVX3 ? 2 : 1;  // clusters
  HWY_INLINE void meet_staged(const int* cluster, const int* end, const bool screened) {
    Distances at, next;
    measure(*cluster, at);
    if constexpr (kAhead == 2) {
      invert(at);
      if (cluster + 1 < end) measure(cluster[1], next);
      for (; cluster + 2 < end; ++cluster) {
        Distances last;
        measure(cluster[2], last);
        invert(next);
        finish(at, screened);
        at = next;
        next = last;
      }
    } else {
      for (; cluster + 2 < end; cluster += 2) {  // by twos, so that nothing moves from register to register
        measure(cluster[1], next);
        invert(at);
        finish(at, screened);
        measure(cluster[2], at);
        invert(next);
        finish(next, screened);
      }
      if (cluster + 1 < end) measure(cluster[1], next);
      invert(at);
    }
    finish(at, screened);
    if (cluster + 1 == end) return;
    invert(next);
    finish(next, screened);
  }
  HWY_INLINE void finish(Distances& at, bool screened) {
    LawValues terms;
    apply_law(at, screened, terms);
    add_forces(at, terms);
  }

  HWY_INLINE void meet(int cluster) {
    Distances at;
    LawValues terms;
    measure(cluster, at);
    invert(at);
    apply_law(at, law_.screened(), terms);
    for (int part = 0; part < kParts; ++part) {
      V& term = terms.of[part][0];
      term = hn::IfThenElseZero(counted(part), term);
      if constexpr (choice.energy()) sum_[0] += term;
      if constexpr (choice.virial()) add_virial(at.r[part], term);
    }
    if constexpr (!choice.sums()) add_forces(at, terms);
  }

  HWY_INLINE void add_virial(const V (&r)[3], V term) {
    if constexpr (sizeof(T) == 4) term *= unit2_;
    const V f[3] = {term * r[0], term * r[1], term * r[2]};
    for (int k = 0; k < 3; ++k) sum_[k] += r[k] * f[k];
    sum_[3] += r[0] * f[1];
    sum_[4] += r[0] * f[2];
    sum_[5] += r[1] * f[2];
  }

  HWY_INLINE void measure(int cluster, Distances& out) const {
    const DX d;
    out.slot = 4 * std::ptrdiff_t{cluster};
    for (int part = 0; part < kParts; ++part) {
      V(&r)[3] = out.r[part];
      const auto* x = x_of_ + 3 * out.slot + part * S::kColumns;
      for (int k = 0; k < 3; ++k) r[k] = as_real(load_columns(d, x + 4 * k) - x_[k]);
      V r2 = square(r);
      if constexpr (sizeof(T) == 4) r2 *= unit2_;
      out.r2[part][0] = r2;
      out.guess[part][0] = Law::guess(r2);
    }
  }

  HWY_INLINE void invert(Distances& at) const {
    for (int part = 0; part < kParts; ++part) Law::template invert<1>(at.r2[part], at.guess[part]);
  }

  HWY_INLINE void apply_law(Distances& at, bool screened, LawValues& out) const {
    for (int part = 0; part < kParts; ++part) {
      const V(&r2)[1] = at.r2[part];
      V(&term)[1] = out.of[part];
      law_.template pairs<1>(atoms_, {at.slot + part * S::kColumns}, r2, at.guess[part], screened, term);
      term[0] = hn::IfThenZeroElse(r2[0] > cutoff2_, term[0]);  // NaN must show
    }
  }

  HWY_INLINE void add_forces(const Distances& at, const LawValues& terms) {
    const D d;
    for (int part = 0; part < kParts; ++part) {
      const V(&r)[3] = at.r[part];
      const V term = terms.of[part][0];
      T* f = f_ + 3 * S::kRows * at.slot + part * kLanes;
      for (int i = 0; i < 3; ++i) own_f_[i] -= term * r[i];
      for (int i = 0; i < 3; ++i, f += kParts * kLanes) hn::Store(hn::Load(d, f) + term * r[i], d, f);
    }
  }

  static HWY_INLINE V as_real(VX difference) {
    if constexpr (sizeof(T) == 4)
      return hn::ConvertTo(D(), difference);
    else
      return difference;
  }

  // Bits 4i + j of the row's atoms i and of the cluster's part.
  HWY_INLINE auto counted(int part) const {
    std::uint8_t bytes[8] = {};
    std::uint32_t bits = mask_;
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
    const int cluster = row.first / kClusterAtoms, at = row.first % kClusterAtoms;
    const std::uint64_t bits = diagonal << at % S::kColumns;
    const auto own = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
    T* f = f_ + (3 * cluster * kParts + at / S::kColumns % kParts) * kLanes;
    for (int k = 0; k < 3; ++k) {
      hn::Store(hn::Load(d, f) + hn::IfThenElseZero(own, sum_columns(d, own_f_[k])), d, f);
      f += kParts * kLanes;
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
  // Of the row's atoms: positions, the forces on them so far, and the numbers that the law needs.
  VX x_[3];
  V own_f_[3];
  typename Law::Atoms atoms_;
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
int rows(const Real*) {
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
HWY_EXPORT(rows);
HWY_EXPORT(fit);

template <>
int row_atoms<Real>() {
  return HWY_DYNAMIC_DISPATCH(rows)(nullptr);
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
