#include "forcefield/clusters/pair_kernels.hpp"

#include <algorithm>
#include <cmath>

#ifndef TAUT_PAIR_ASK
#define TAUT_PAIR_ASK
namespace taut {
enum class Ask { kForces, kEnergy, kVirial };  // what is summed over pairs
}
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/pair_kernels.cpp"
#include "forcefield/clusters/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/clusters/inverses-inl.hpp"
#include "forcefield/clusters/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <bool lj, bool charge, bool one_sigma_, bool switched_, Ask ask>
struct Choice {
  static constexpr bool kLj = lj, kCharge = charge, kOneSigma = one_sigma_, kSwitched = switched_;
  static constexpr bool kEnergy = ask == Ask::kEnergy, kVirial = ask == Ask::kVirial;
  static constexpr bool kSum = kEnergy || kVirial;  // one number, no forces
  // What the law is made of: 1/r, for energies and switches; 1/r³, for charges; 1/r², without them.
  static constexpr bool kFromRoot = kSwitched || (charge && kEnergy), kFromCube = charge && !kFromRoot;
  static constexpr bool kShortest = kOneSigma && !kSwitched && !kEnergy;  // of Lennard-Jones' ways
};

// Rows of one kind against their clusters.
template <class T, class C>
class RowSum {
  using S = Shape<T>;
  using D = typename S::D;
  using V = typename S::V;
  using DX = typename S::DX;
  using VX = typename S::VX;
  static constexpr int kVectors = S::kVectors, kParts = S::kParts, kLanes = S::kLanes;
  static constexpr int kPlaces = kVectors * kParts;  // vectors a cluster

 public:
  HWY_INLINE RowSum(const PairLaw& law, const PairAtoms<T>& atoms, T* f)
      : x_of_(atoms.x.data()),
        charge_(atoms.charge.data()),
        half_sigma_(atoms.half_sigma.data()),
        two_sqrt_epsilon_(atoms.two_sqrt_epsilon.data()),
        unit_(atoms.unit),
        f_(f),
        cutoff2_(set(law.cutoff * law.cutoff)),
        k_rf_(set(law.k_rf)),
        two_k_rf_(set(2 * law.k_rf)),
        c_rf_(set(law.c_rf)),
        sigma6_(set(law.sigma6())),
        six_sigma6_(set(6 * law.sigma6())),
        twelve_sigma12_(set(12 * law.sigma6() * law.sigma6())),
        lift_(set(law.lift / 4)),
        unit2_(set(atoms.unit * atoms.unit)),
        sum_(set(0)) {
    if constexpr (C::kSwitched) {
      const double width = law.cutoff - law.switch_distance;
      inv_width_ = set(1 / width);
      start_ = set(law.switch_distance / width);
      slope_width_ = set(30 / width);
    }
  }

  HWY_INLINE void add(const PairRow& row, const ClusterList& list) {
    load(row);
    for (int k = row.masked_begin; k < row.masked_end; ++k) {
      mask_ = list.masked[k].mask;
      meet<1, true>(&list.masked[k].cluster);
    }
    const int* clusters = list.clusters.data();
    if constexpr (C::kSum) {
      for (int k = row.begin; k < row.end; ++k) meet<1, false>(clusters + k);
      total_ += double(hn::GetLane(hn::SumOfLanes(D(), sum_)));
      sum_ = set(0);
    } else {
      meet_all(clusters + row.begin, row.end - row.begin);
      store(row);
    }
  }

  double total() const { return total_; }

 private:
  static HWY_INLINE V set(double value) { return hn::Set(D(), static_cast<T>(value)); }

  HWY_INLINE void load(const PairRow& row) {
    const D d;
    load_row<T>(x_of_, unit_, row, x_);
    for (int v = 0; v < kVectors; ++v) {
      const int at = row.first + v * S::kRows;
      if constexpr (C::kCharge) q_[v] = load_rows(d, charge_ + at);
      if constexpr (C::kLj) {
        eps_[v] = load_rows(d, two_sqrt_epsilon_ + at);
        repulsion_[v] = hn::Mul(eps_[v], twelve_sigma12_);
        attraction_[v] = hn::Mul(eps_[v], six_sigma6_);
      }
      if constexpr (C::kLj && !C::kOneSigma) sigma_[v] = load_rows(d, half_sigma_ + at);
      for (int k = 0; k < 3; ++k) own_f_[k][v] = hn::Zero(d);
    }
  }

  // The row against K clusters, all different: distances with the guess the law starts from, then the law,
  // then forces or sums.
  template <int K>
  struct Distances {
    V r2[kPlaces][K], guess[kPlaces][K];
  };
  template <int K>
  struct Terms {
    V of[kPlaces][K];
  };

  // One stage waits for another longer than the processor can look ahead: so they take turns, each with
  // clusters of its own.
  static constexpr int kLong = 10;  // rows, for that
  HWY_INLINE void meet_all(const int* clusters, int count) {
    constexpr int K = 2;
    int k = 0;
    if (count >= kLong) {
      Distances<K> distances, next;
      Terms<K> terms;
      measure(clusters, distances);
      apply_law<K, false>(clusters, distances, terms);
      measure(clusters + K, distances);
      for (k = 2 * K; k + K <= count; k += K) {
        measure(clusters + k, next);
        add_forces(clusters + k - 2 * K, terms);
        apply_law<K, false>(clusters + k - K, distances, terms);
        distances = next;
      }
      add_forces(clusters + k - 2 * K, terms);
      apply_law<K, false>(clusters + k - K, distances, terms);
      add_forces(clusters + k - K, terms);
    }
    for (; k + 3 <= count; k += 3) meet<3, false>(clusters + k);
    for (; k < count; ++k) meet<1, false>(clusters + k);
  }

  template <int K, bool kMasked>
  HWY_INLINE void meet(const int* clusters) {
    Distances<K> distances;
    Terms<K> terms;
    measure(clusters, distances);
    apply_law<K, kMasked>(clusters, distances, terms);
    if constexpr (!C::kSum) add_forces(clusters, terms);
    for (int place = 0; place < kPlaces; ++place)
      for (int k = 0; k < K; ++k) {
        if constexpr (C::kEnergy) sum_ = hn::Add(sum_, terms.of[place][k]);
        if constexpr (C::kVirial) sum_ = hn::MulAdd(terms.of[place][k], distances.r2[place][k], sum_);
      }
  }

  HWY_INLINE void subtract(std::ptrdiff_t cluster, int place, V (&r)[3]) const {
    const DX d;
    const int v = place % kVectors, part = place / kVectors;
    const auto* x = x_of_ + 12 * cluster + part * S::kColumns;
    for (int k = 0; k < 3; ++k) r[k] = number(hn::Sub(x_[k][v], load_columns(d, x + 4 * k)));
  }

  template <int K>
  HWY_INLINE void measure(const int* clusters, Distances<K>& out) const {
    const D d;
    for (int place = 0; place < kPlaces; ++place) {
      V r[K][3];
      for (int k = 0; k < K; ++k) subtract(clusters[k], place, r[k]);
      for (int k = 0; k < K; ++k) {
        V r2 = hn::MulAdd(r[k][0], r[k][0], hn::MulAdd(r[k][1], r[k][1], hn::Mul(r[k][2], r[k][2])));
        if constexpr (sizeof(T) == 4) r2 = hn::Mul(r2, unit2_);
        out.r2[place][k] = r2;
      }
      for (int k = 0; k < K; ++k)
        out.guess[place][k] = C::kFromRoot || C::kFromCube ? guess_inverse_sqrt(d, out.r2[place][k])
                                                           : guess_inverse(d, out.r2[place][k]);
    }
  }

  template <int K, bool kMasked>
  HWY_INLINE void apply_law(const int* clusters, Distances<K>& at, Terms<K>& out) const {
    for (int place = 0; place < kPlaces; ++place) {
      const int v = place % kVectors, part = place / kVectors;
      std::ptrdiff_t j[K];
      for (int k = 0; k < K; ++k) j[k] = 4 * std::ptrdiff_t{clusters[k]} + part * S::kColumns;
      const V(&r2)[K] = at.r2[place];
      V(&term)[K] = out.of[place];
      pair<K>(v, j, r2, at.guess[place], term);
      for (int k = 0; k < K; ++k) {
        term[k] = hn::IfThenElseZero(hn::Not(hn::Gt(r2[k], cutoff2_)), term[k]);  // NaN must show
        if constexpr (kMasked) term[k] = hn::IfThenElseZero(counted(mask_, v, part), term[k]);
      }
    }
  }

  template <int K>
  HWY_INLINE void add_forces(const int* clusters, const Terms<K>& terms) {
    const D d;
    for (int place = 0; place < kPlaces; ++place) {
      const int v = place % kVectors, part = place / kVectors;
      for (int k = 0; k < K; ++k) {
        V r[3];
        subtract(clusters[k], place, r);
        const V term = terms.of[place][k];
        T* f = f_ + (3 * std::ptrdiff_t{clusters[k]} * kParts + part) * kLanes;
        for (int i = 0; i < 3; ++i) own_f_[i][v] = hn::MulAdd(term, r[i], own_f_[i][v]);
        for (int i = 0; i < 3; ++i, f += kParts * kLanes)
          hn::Store(hn::NegMulAdd(term, r[i], hn::Load(d, f)), d, f);
      }
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

  // −(dE/dr)/r [kJ/mol/nm²], or E [kJ/mol].
  template <int K>
  HWY_INLINE void pair(int v, const std::ptrdiff_t (&j)[K], const V (&r2)[K], V (&guess)[K],
                       V (&term)[K]) const {
    const D d;
    V inv_r3[K];
    if constexpr (C::kFromCube) {
      inverse_cube<K>(d, r2, guess);
    } else if constexpr (C::kFromRoot) {
      inverse_sqrt<K>(d, r2, guess);
    } else {
      inverse<K>(d, r2, guess);
    }
    for (int k = 0; k < K; ++k) {
      if constexpr (C::kFromCube) inv_r3[k] = guess[k];
      if constexpr (C::kFromRoot) inv_r3[k] = hn::Mul(guess[k], hn::Mul(guess[k], guess[k]));
      if constexpr (C::kLj) term[k] = lennard_jones(v, j[k], r2[k], guess[k]);
      if constexpr (C::kCharge) {
        const V qq = hn::Mul(q_[v], load_columns(d, charge_ + j[k]));
        const V coulomb =
            C::kEnergy ? hn::Sub(hn::MulAdd(k_rf_, r2[k], guess[k]), c_rf_) : hn::Sub(inv_r3[k], two_k_rf_);
        term[k] = C::kLj ? hn::MulAdd(qq, coulomb, term[k]) : hn::Mul(qq, coulomb);
      }
    }
  }

  // `inverse`: 1/r³, 1/r or 1/r².
  HWY_INLINE V lennard_jones(int v, std::ptrdiff_t j, V r2, V inverse) const {
    const D d;
    const V eps_j = load_columns(d, two_sqrt_epsilon_ + j);
    V inv_r2, inv_r4, inv_r6;
    if constexpr (C::kFromCube) {
      inv_r6 = hn::Mul(inverse, inverse);
      inv_r4 = hn::Mul(inv_r6, r2);
      inv_r2 = hn::Mul(inv_r4, r2);
    } else {
      inv_r2 = C::kFromRoot ? hn::Mul(inverse, inverse) : inverse;
      inv_r4 = hn::Mul(inv_r2, inv_r2);
      inv_r6 = hn::Mul(inv_r4, inv_r2);
    }
    if constexpr (C::kShortest)
      return hn::Mul(hn::Mul(inv_r4, hn::Mul(inv_r4, eps_j)),
                     hn::MulSub(repulsion_[v], inv_r6, attraction_[v]));
    V s6;
    if constexpr (C::kOneSigma) {
      s6 = hn::Mul(sigma6_, inv_r6);
    } else {
      const V sigma = hn::Add(sigma_[v], load_columns(d, half_sigma_ + j)), sigma2 = hn::Mul(sigma, sigma);
      s6 = hn::Mul(hn::Mul(hn::Mul(sigma2, sigma2), sigma2), inv_r6);
    }
    const V four_eps = hn::Mul(eps_[v], eps_j), depth = hn::Mul(four_eps, s6);
    V slope{}, energy{};
    if constexpr (!C::kEnergy || C::kSwitched)
      slope = hn::Mul(hn::Mul(depth, hn::MulSub(set(12), s6, set(6))), inv_r2);
    if constexpr (C::kEnergy || C::kSwitched) energy = hn::MulSub(depth, s6, depth);
    if constexpr (C::kSwitched) {
      // S = 1 − u³(10 − 15u + 6u²), S' = −30 (u − u²)²; the force gains −E S'/r
      const V inv_r = inverse;
      const V u = hn::Max(hn::MulSub(hn::Mul(r2, inv_r), inv_width_, start_), hn::Zero(d));
      const V u2 = hn::Mul(u, u), u_less_u2 = hn::Sub(u, u2);
      const V fade =
          hn::MulAdd(hn::Mul(u2, u), hn::MulAdd(u, hn::NegMulAdd(set(6), u, set(15)), set(-10)), set(1));
      const V fade_slope = hn::Mul(hn::Mul(u_less_u2, u_less_u2), slope_width_);
      slope = hn::MulAdd(hn::Mul(energy, fade_slope), inv_r, hn::Mul(slope, fade));
      energy = hn::Mul(energy, fade);
    }
    return C::kEnergy ? hn::MulAdd(lift_, four_eps, energy) : slope;
  }

  // The row's own forces go to lanes of its atoms: any copy will do.
  HWY_INLINE void store(const PairRow& row) {
    const D d;
    const int cluster = row.first / kClusterAtoms;
    for (int v = 0; v < kVectors; ++v) {
      const int at = row.first % kClusterAtoms + v * S::kRows;
      std::uint8_t bytes[8] = {};
      for (int i = 0; i < S::kRows; ++i) {
        const int lane = i * S::kColumns + (at + i) % S::kColumns;
        bytes[lane / 8] = static_cast<std::uint8_t>(bytes[lane / 8] | 1u << lane % 8);
      }
      const auto own = hn::LoadMaskBits(d, bytes);
      T* f = f_ + (3 * cluster * kParts + at / S::kColumns % kParts) * kLanes;
      for (int k = 0; k < 3; ++k) {
        hn::Store(hn::Add(hn::Load(d, f), hn::IfThenElseZero(own, sum_columns(d, own_f_[k][v]))), d, f);
        f += kParts * kLanes;
      }
    }
  }

  const typename S::Coordinate* HWY_RESTRICT x_of_;
  const T* HWY_RESTRICT charge_;
  const T* HWY_RESTRICT half_sigma_;
  const T* HWY_RESTRICT two_sqrt_epsilon_;
  double unit_;
  T* HWY_RESTRICT f_;
  V cutoff2_, k_rf_, two_k_rf_, c_rf_, sigma6_, six_sigma6_, twelve_sigma12_, lift_, unit2_, start_{},
      inv_width_{}, slope_width_{};
  V sum_;
  double total_ = 0;
  std::uint32_t mask_ = 0;
  VX x_[3][kVectors];
  V own_f_[3][kVectors];
  V q_[kVectors], eps_[kVectors], sigma_[kVectors];
  V repulsion_[kVectors], attraction_[kVectors];  // 12 σ¹² and 6 σ⁶, times eps_
};

struct Rows {
  const PairLaw& law;
  const ClusterList& list;
  std::size_t begin, end;
};

template <class T, class C>
HWY_NOINLINE double sum_kind(const Rows& rows, const PairAtoms<T>& atoms, int kind, T* f) {
  RowSum<T, C> sum(rows.law, atoms, f);
  for (std::size_t r = rows.begin; r < rows.end; ++r)
    if (rows.list.rows[r].kind == kind) sum.add(rows.list.rows[r], rows.list);
  return sum.total();
}

template <class T, bool lj, bool charge, Ask ask>
double choose_law(const Rows& rows, const PairAtoms<T>& atoms, T* f) {
  const int kind = (lj ? kHasLj : 0) | (charge ? kHasCharge : 0);
  if constexpr (!lj) return sum_kind<T, Choice<false, charge, true, false, ask>>(rows, atoms, kind, f);
  if (rows.law.switched())
    return rows.law.one_sigma ? sum_kind<T, Choice<lj, charge, true, true, ask>>(rows, atoms, kind, f)
                              : sum_kind<T, Choice<lj, charge, false, true, ask>>(rows, atoms, kind, f);
  return rows.law.one_sigma ? sum_kind<T, Choice<lj, charge, true, false, ask>>(rows, atoms, kind, f)
                            : sum_kind<T, Choice<lj, charge, false, false, ask>>(rows, atoms, kind, f);
}

// Kinds take turns, so that rows near each other find the same clusters still in the cache.
template <class T, Ask ask>
double sum_all(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, T* f) {
  constexpr std::size_t kTurn = 256;  // rows
  double sum = 0;
  for (std::size_t begin = 0; begin < list.rows.size(); begin += kTurn) {
    const Rows rows{law, list, begin, std::min(begin + kTurn, list.rows.size())};
    if (law.charge) sum += choose_law<T, false, true, ask>(rows, atoms, f);
    if (law.lj) sum += choose_law<T, true, false, ask>(rows, atoms, f);
    if (law.lj && law.charge) sum += choose_law<T, true, true, ask>(rows, atoms, f);
  }
  return sum;
}

void forces_double(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list, double* f) {
  sum_all<double, Ask::kForces>(law, atoms, list, f);
}
void forces_float(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list, float* f) {
  sum_all<float, Ask::kForces>(law, atoms, list, f);
}
double energy_double(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list) {
  return sum_all<double, Ask::kEnergy>(law, atoms, list, nullptr);
}
double energy_float(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list) {
  return sum_all<float, Ask::kEnergy>(law, atoms, list, nullptr);
}
double virial_double(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list) {
  return sum_all<double, Ask::kVirial>(law, atoms, list, nullptr);
}
double virial_float(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list) {
  return sum_all<float, Ask::kVirial>(law, atoms, list, nullptr);
}
int copies_double() {
  return Shape<double>::kRows;
}
int copies_float() {
  return Shape<float>::kRows;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(forces_double);
HWY_EXPORT(forces_float);
HWY_EXPORT(energy_double);
HWY_EXPORT(energy_float);
HWY_EXPORT(virial_double);
HWY_EXPORT(virial_float);
HWY_EXPORT(copies_double);
HWY_EXPORT(copies_float);

template <>
int force_copies<double>() {
  return HWY_DYNAMIC_DISPATCH(copies_double)();
}
template <>
int force_copies<float>() {
  return HWY_DYNAMIC_DISPATCH(copies_float)();
}
template <>
void add_pair_forces(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list, double* f) {
  HWY_DYNAMIC_DISPATCH(forces_double)(law, atoms, list, f);
}
template <>
void add_pair_forces(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list, float* f) {
  HWY_DYNAMIC_DISPATCH(forces_float)(law, atoms, list, f);
}
template <>
double pair_energy(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(energy_double)(law, atoms, list);
}
template <>
double pair_energy(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(energy_float)(law, atoms, list);
}
template <>
double pair_virial(const PairLaw& law, const PairAtoms<double>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(virial_double)(law, atoms, list);
}
template <>
double pair_virial(const PairLaw& law, const PairAtoms<float>& atoms, const ClusterList& list) {
  return HWY_DYNAMIC_DISPATCH(virial_float)(law, atoms, list);
}

}  // namespace taut
#endif
