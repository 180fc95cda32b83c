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
  // Clusters taken together, so that the processor has enough to do at once.
  static constexpr int kAtOnce = 3;

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
        sigma2_(set(law.sigma * law.sigma)),
        six_sigma6_(set(6 * std::pow(law.sigma, 6))),
        twelve_sigma12_(set(12 * std::pow(law.sigma, 12))),
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
    int k = row.begin;
    for (; k + kAtOnce <= row.end; k += kAtOnce) meet<kAtOnce, false>(clusters + k);
    for (; k < row.end; ++k) meet<1, false>(clusters + k);
    if constexpr (C::kSum) {
      total_ += double(hn::GetLane(hn::SumOfLanes(D(), sum_)));
      sum_ = set(0);
    } else {
      store(row);
    }
  }

  double total() const { return total_; }

 private:
  static HWY_INLINE V set(double value) { return hn::Set(D(), static_cast<T>(value)); }

  HWY_INLINE void load(const PairRow& row) {
    const D d;
    VX x[3][kVectors];
    load_row<T>(x_of_, unit_, row, x);
    for (int v = 0; v < kVectors; ++v) {
      const int at = v * S::kRows;
      x_[v] = x[0][v];
      y_[v] = x[1][v];
      z_[v] = x[2][v];
      if constexpr (C::kCharge) q_[v] = load_rows(d, charge_ + row.first + at);
      if constexpr (C::kLj) eps_[v] = load_rows(d, two_sqrt_epsilon_ + row.first + at);
      if constexpr (C::kLj && !C::kOneSigma) sigma_[v] = load_rows(d, half_sigma_ + row.first + at);
      fx_[v] = fy_[v] = fz_[v] = hn::Zero(d);
    }
  }

  // The row against K clusters, all different.
  template <int K, bool kMasked>
  HWY_INLINE void meet(const int* clusters) {
    const D d;
    const DX dxs;
    for (int part = 0; part < kParts; ++part)
      for (int v = 0; v < kVectors; ++v) {
        V dx[K], dy[K], dz[K], r2[K], term[K];
        int j[K];
        for (int k = 0; k < K; ++k) {
          const auto* x = x_of_ + 12 * clusters[k] + part * S::kColumns;
          j[k] = 4 * clusters[k] + part * S::kColumns;
          dx[k] = number(hn::Sub(x_[v], load_columns(dxs, x)));
          dy[k] = number(hn::Sub(y_[v], load_columns(dxs, x + 4)));
          dz[k] = number(hn::Sub(z_[v], load_columns(dxs, x + 8)));
        }
        for (int k = 0; k < K; ++k) {
          r2[k] = hn::MulAdd(dx[k], dx[k], hn::MulAdd(dy[k], dy[k], hn::Mul(dz[k], dz[k])));
          if constexpr (sizeof(T) == 4) r2[k] = hn::Mul(r2[k], unit2_);
        }
        pair<K>(v, j, r2, term);
        for (int k = 0; k < K; ++k) {
          term[k] = hn::IfThenZeroElse(hn::Gt(r2[k], cutoff2_), term[k]);  // not for NaN: it must show
          if constexpr (kMasked) term[k] = hn::IfThenElseZero(counted(mask_, v, part), term[k]);
        }
        for (int k = 0; k < K; ++k) {
          if constexpr (C::kEnergy) {
            sum_ = hn::Add(sum_, term[k]);
          } else if constexpr (C::kVirial) {
            sum_ = hn::MulAdd(term[k], r2[k], sum_);
          } else {
            fx_[v] = hn::MulAdd(term[k], dx[k], fx_[v]);
            fy_[v] = hn::MulAdd(term[k], dy[k], fy_[v]);
            fz_[v] = hn::MulAdd(term[k], dz[k], fz_[v]);
            T* f = f_ + (3 * clusters[k] * kParts + part) * kLanes;
            hn::Store(hn::NegMulAdd(term[k], dx[k], hn::Load(d, f)), d, f);
            f += kParts * kLanes;
            hn::Store(hn::NegMulAdd(term[k], dy[k], hn::Load(d, f)), d, f);
            f += kParts * kLanes;
            hn::Store(hn::NegMulAdd(term[k], dz[k], hn::Load(d, f)), d, f);
          }
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
  HWY_INLINE void pair(int v, const int (&j)[K], const V (&r2)[K], V (&term)[K]) const {
    const D d;
    V inv_r[K], inv_r2[K];
    constexpr bool kNeedsR = C::kCharge || C::kSwitched;
    if constexpr (kNeedsR) {
      inverse_sqrt<K>(d, r2, inv_r);
      for (int k = 0; k < K; ++k) inv_r2[k] = hn::Mul(inv_r[k], inv_r[k]);
    } else {
      inverse<K>(d, r2, inv_r2);
    }
    if constexpr (C::kLj)
      for (int k = 0; k < K; ++k)
        term[k] = lennard_jones(v, j[k], r2[k], kNeedsR ? inv_r[k] : inv_r2[k], inv_r2[k]);
    if constexpr (C::kCharge)
      for (int k = 0; k < K; ++k) {
        const V qq = hn::Mul(q_[v], load_columns(d, charge_ + j[k]));
        const V coulomb = C::kEnergy ? hn::Sub(hn::MulAdd(k_rf_, r2[k], inv_r[k]), c_rf_)
                                     : hn::MulSub(inv_r[k], inv_r2[k], two_k_rf_);
        term[k] = C::kLj ? hn::MulAdd(qq, coulomb, term[k]) : hn::Mul(qq, coulomb);
      }
  }

  HWY_INLINE V lennard_jones(int v, int j, [[maybe_unused]] V r2, [[maybe_unused]] V inv_r, V inv_r2) const {
    const D d;
    const V four_eps = hn::Mul(eps_[v], load_columns(d, two_sqrt_epsilon_ + j));
    if constexpr (C::kOneSigma && !C::kEnergy && !C::kSwitched) {  // the shortest way
      const V inv_r4 = hn::Mul(inv_r2, inv_r2), inv_r6 = hn::Mul(inv_r4, inv_r2);
      return hn::Mul(hn::Mul(four_eps, hn::Mul(inv_r4, inv_r4)),
                     hn::MulSub(twelve_sigma12_, inv_r6, six_sigma6_));
    }
    V s2;
    if constexpr (C::kOneSigma) {
      s2 = hn::Mul(sigma2_, inv_r2);
    } else {
      const V sigma = hn::Add(sigma_[v], load_columns(d, half_sigma_ + j));
      s2 = hn::Mul(hn::Mul(sigma, sigma), inv_r2);
    }
    const V s6 = hn::Mul(hn::Mul(s2, s2), s2), depth = hn::Mul(four_eps, s6);
    V slope{}, energy{};
    if constexpr (!C::kEnergy || C::kSwitched)
      slope = hn::Mul(hn::Mul(depth, hn::MulSub(set(12), s6, set(6))), inv_r2);
    if constexpr (C::kEnergy || C::kSwitched) energy = hn::MulSub(depth, s6, depth);
    if constexpr (C::kSwitched) {
      // S = 1 − u³(10 − 15u + 6u²), S' = −30 (u − u²)²; the force gains −E S'/r
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
      for (const V& sum : {fx_[v], fy_[v], fz_[v]}) {
        hn::Store(hn::Add(hn::Load(d, f), hn::IfThenElseZero(own, sum_columns(d, sum))), d, f);
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
  V cutoff2_, k_rf_, two_k_rf_, c_rf_, sigma2_, six_sigma6_, twelve_sigma12_, lift_, unit2_, start_{},
      inv_width_{}, slope_width_{};
  V sum_;
  double total_ = 0;
  std::uint32_t mask_ = 0;
  VX x_[kVectors], y_[kVectors], z_[kVectors];
  V q_[kVectors], eps_[kVectors], sigma_[kVectors], fx_[kVectors], fy_[kVectors], fz_[kVectors];
};

template <class T, class C>
HWY_NOINLINE double sum_kind(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, int kind,
                             T* f) {
  RowSum<T, C> sum(law, atoms, f);
  for (const PairRow& row : list.rows)
    if (row.kind == kind) sum.add(row, list);
  return sum.total();
}

template <class T, bool lj, bool charge, Ask ask>
double choose_law(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, T* f) {
  const int kind = (lj ? kHasLj : 0) | (charge ? kHasCharge : 0);
  if constexpr (!lj) return sum_kind<T, Choice<false, charge, true, false, ask>>(law, atoms, list, kind, f);
  if (law.switched())
    return law.one_sigma ? sum_kind<T, Choice<lj, charge, true, true, ask>>(law, atoms, list, kind, f)
                         : sum_kind<T, Choice<lj, charge, false, true, ask>>(law, atoms, list, kind, f);
  return law.one_sigma ? sum_kind<T, Choice<lj, charge, true, false, ask>>(law, atoms, list, kind, f)
                       : sum_kind<T, Choice<lj, charge, false, false, ask>>(law, atoms, list, kind, f);
}

template <class T, Ask ask>
double sum_all(const PairLaw& law, const PairAtoms<T>& atoms, const ClusterList& list, T* f) {
  double sum = 0;
  if (law.charge) sum += choose_law<T, false, true, ask>(law, atoms, list, f);
  if (law.lj) sum += choose_law<T, true, false, ask>(law, atoms, list, f);
  if (law.lj && law.charge) sum += choose_law<T, true, true, ask>(law, atoms, list, f);
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
