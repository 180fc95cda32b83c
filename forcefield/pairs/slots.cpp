#include "forcefield/pairs/slots.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pairs/slots.cpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include <hwy/cache_control.h>

#include "base/vector_lanes-inl.hpp"
#include "forcefield/pairs/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kAhead = 32;  // atoms prefetched before their turn: they lie anywhere in memory

template <class T>
HWY_INLINE void place_cluster(const double* const (&from)[4], const Vec3* offset, double inv_unit,
                              double* now, typename PairPrecision<T>::Coordinate* to) {
#if HWY_TARGET <= HWY_AVX2
  const Four d;
  const auto three = hn::FirstN(d, 3);
  FourV atom[4], axis[3];
  for (int i = 0; i < 4; ++i)
    atom[i] = hn::MaskedLoad(three, d, from[i]) + hn::MaskedLoad(three, d, offset[i].data());
  by_axes(atom, axis);
  for (int k = 0; k < 3; ++k) {
    hn::StoreU(axis[k], d, now + 4 * k);
    if constexpr (sizeof(T) == 8) {
      hn::StoreU(axis[k] * inv_unit, d, to + 4 * k);
    } else {  // PairPrecision<float>::coordinate
      const hn::Rebind<std::uint32_t, Four> low;
      const auto moved = axis[k] * inv_unit + PairPrecision<T>::kWholeInLowBits;
      hn::StoreU(hn::TruncateTo(low, hn::BitCast(hn::RebindToUnsigned<Four>(), moved)), low,
                 reinterpret_cast<std::uint32_t*>(to) + 4 * k);
    }
  }
#else
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      now[4 * k + i] = from[i][k] + offset[i][k];
      to[4 * k + i] = PairPrecision<T>::coordinate(now[4 * k + i] * inv_unit);
    }
#endif
}

template <class T>
void place_all(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
               PairAtoms<T>& to) {
  const double inv_unit = 1 / to.unit;
  const int last = 4 * share.end - 1;
  for (int c = share.begin; c < share.end; ++c) {
    const double* from[4];
    for (int i = 0; i < 4; ++i) {
      from[i] = x.data() + 3 * clusters.atom(4 * c + i);
      hwy::Prefetch(x.data() + 3 * clusters.atom(std::min(4 * c + i + kAhead, last)));
    }
    const std::ptrdiff_t at = entry(4 * std::ptrdiff_t{c}, 0);
    place_cluster<T>(from, &clusters.offset(4 * c), inv_unit, now + at, to.x.data() + at);
  }
}

// The forces on a cluster's four atoms, summed over all copies of all threads that touch it.
template <class T>
HWY_INLINE void add_copies(const SlotForces<T>& from, int cluster, double (&sum)[3][4]) {
  constexpr int kCopies = Shape<T>::kRows;
  const Four d;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 4; i += static_cast<int>(hn::MaxLanes(d))) {
      FourV of_axis = hn::Zero(d);
      for (std::size_t t = 0; t < from.force.size(); ++t) {
        if (!from.reached[t][cluster / SlotForces<T>::kBlock]) continue;
        const T* force = from.force[t].data() + entry(4 * std::ptrdiff_t{cluster}, k, 3, kCopies) + i;
        for (int copy = 0; copy < kCopies; ++copy, force += 4) {
          if constexpr (sizeof(T) == 8)
            of_axis = of_axis + hn::LoadU(d, force);
          else
            of_axis = of_axis + hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, Four>(), force));
        }
      }
      hn::StoreU(of_axis, d, sum[k] + i);
    }
}

template <class T>
void reduce_forces_all(const SlotForces<T>& from, const AtomClusters& clusters, const Share& share,
                       const Reduction& how, Vectors& f) {
  const bool overwrite = how.write == ClusterPairs::Write::kOverwrite;
  const int last = 4 * share.end - 1;
  for (int c = share.begin; c < share.end; ++c) {
    double sum[3][4];
    add_copies(from, c, sum);
    for (int i = 0; i < 4; ++i) {
      const int slot = 4 * c + i;
      hwy::Prefetch(f.data() + 3 * clusters.atom(std::min(slot + kAhead, last)));
      if (clusters.filler(slot)) continue;
      double* out = f.data() + 3 * clusters.atom(slot);
      for (int k = 0; k < 3; ++k) out[k] = (overwrite ? 0 : out[k]) + sum[k][i] * how.unit;
    }
  }
}

void place_float(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                 PairAtoms<float>& to) {
  place_all(x, clusters, share, now, to);
}
void place_double(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                  PairAtoms<double>& to) {
  place_all(x, clusters, share, now, to);
}
void reduce_forces_float(const SlotForces<float>& from, const AtomClusters& clusters, const Share& share,
                         const Reduction& how, Vectors& f) {
  reduce_forces_all(from, clusters, share, how, f);
}
void reduce_forces_double(const SlotForces<double>& from, const AtomClusters& clusters, const Share& share,
                          const Reduction& how, Vectors& f) {
  reduce_forces_all(from, clusters, share, how, f);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(place_float);
HWY_EXPORT(place_double);
HWY_EXPORT(reduce_forces_float);
HWY_EXPORT(reduce_forces_double);

template <>
void place_atoms(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                 PairAtoms<float>& to) {
  HWY_DYNAMIC_DISPATCH(place_float)(x, clusters, share, now, to);
}
template <>
void place_atoms(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                 PairAtoms<double>& to) {
  HWY_DYNAMIC_DISPATCH(place_double)(x, clusters, share, now, to);
}
template <>
void reduce_forces(const SlotForces<float>& from, const AtomClusters& clusters, const Share& share,
                   const Reduction& how, Vectors& f) {
  HWY_DYNAMIC_DISPATCH(reduce_forces_float)(from, clusters, share, how, f);
}
template <>
void reduce_forces(const SlotForces<double>& from, const AtomClusters& clusters, const Share& share,
                   const Reduction& how, Vectors& f) {
  HWY_DYNAMIC_DISPATCH(reduce_forces_double)(from, clusters, share, how, f);
}

}  // namespace taut
#endif
