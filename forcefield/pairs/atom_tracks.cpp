#include "forcefield/pairs/atom_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pairs/atom_tracks.cpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

using Four = hn::CappedTag<double, 4>;  // a cluster's, or as many as fit
using FourV = hn::Vec<Four>;
using FourRounded = hn::Rebind<float, Four>;
constexpr int kOfFour = static_cast<int>(hn::MaxLanes(Four()));

HWY_INLINE FourV rounded(const float* p) {
  return hn::PromoteTo(Four(), hn::LoadU(FourRounded(), p));
}

HWY_INLINE FourV squared(const FourV (&r)[3]) {
  return r[2] * r[2] + r[1] * r[1] + r[0] * r[0];
}

// Puts the centre of each margin halfway along the way w that the atom is expected to go, so that a margin of |w|/2
// covers all of it. An atom without a history, or one that seems to move too far, as after a jump, stays the centre
// itself and gets the widest margin.
double look_ahead_simd(const AtomTracks::Course& course, const Share& clusters, float* places) {
  const Four d;
  const FourRounded f;
  const FourV farthest = hn::Set(d, course.farthest);
  const FourV spare = hn::Set(d, course.spare), unknown = hn::Set(d, course.unknown);
  FourV sum = hn::Zero(d);
  for (int c = clusters.begin; c < clusters.end; ++c)
    for (int i = 0; i < 4; i += kOfFour) {
      float* to = places + entry(4 * std::ptrdiff_t{c}, 0, 4) + i;
      FourV x[3], way[3], off[3];
      for (int k = 0; k < 3; ++k) {
        const std::ptrdiff_t at = entry(4 * std::ptrdiff_t{c}, k) + i;
        x[k] = hn::LoadU(d, course.x[0] + at);
        way[k] = course.weight[0] * x[k];
        for (int n = 1; n < 3; ++n) way[k] += course.weight[n] * hn::LoadU(d, course.x[n] + at);
      }
      const FourV half_way = 0.5 * hn::Sqrt(squared(way));
      const auto trusted = half_way <= farthest;  // false for NaN
      for (int k = 0; k < 3; ++k) {
        hn::StoreU(hn::DemoteTo(f, x[k] + hn::IfThenElseZero(trusted, 0.5 * way[k])), f, to + 4 * k);
        off[k] = rounded(to + 4 * k) - x[k];  // w/2 as the list has it, rounded
      }
      const FourV margin = hn::Sqrt(squared(off)) + hn::IfThenElse(trusted, spare, unknown);
      hn::StoreU(hn::DemoteTo(f, margin), f, to + 12);
      sum += hn::IfThenElse(trusted, half_way, farthest);
    }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

bool covers_all_simd(const double* x, const float* places, const Share& clusters) {
  const Four d;
  auto all = hn::FirstN(d, kOfFour);
  for (int c = clusters.begin; c < clusters.end; ++c)
    for (int i = 0; i < 4; i += kOfFour) {
      const float* there = places + entry(4 * std::ptrdiff_t{c}, 0, 4) + i;
      FourV r[3];
      for (int k = 0; k < 3; ++k)
        r[k] = hn::LoadU(d, x + entry(4 * std::ptrdiff_t{c}, k) + i) - rounded(there + 4 * k);
      const FourV margin = rounded(there + 12);
      all = hn::And(all, squared(r) <= margin * margin);  // false for NaN
    }
  return hn::AllTrue(d, all);
}

double farthest_simd(const float* searched, const Share& clusters, const float* places, double* each) {
  const Four d;
  const FourV nowhere = hn::Set(d, std::numeric_limits<double>::infinity());
  double farthest = 0;
  for (int c = clusters.begin; c < clusters.end; ++c) {
    FourV of_cluster = hn::Zero(d);
    for (int i = 0; i < 4; i += kOfFour) {
      const std::ptrdiff_t at = entry(4 * std::ptrdiff_t{c}, 0, 4) + i;
      FourV r[3];
      for (int k = 0; k < 3; ++k) r[k] = rounded(places + at + 4 * k) - rounded(searched + at + 4 * k);
      const FourV far = hn::Sqrt(squared(r)) + rounded(places + at + 12);
      of_cluster = hn::Max(of_cluster, hn::IfThenElse(far <= nowhere, far, nowhere));  // NaN is nowhere
    }
    each[c] = hn::GetLane(hn::MaxOfLanes(d, of_cluster));
    farthest = std::max(farthest, each[c]);
  }
  return farthest;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {
namespace {

constexpr double kFarthest = 100;  // T

HWY_EXPORT(look_ahead_simd);
HWY_EXPORT(covers_all_simd);
HWY_EXPORT(farthest_simd);

}  // namespace

void AtomTracks::make_room(int clusters, Eigen::Index atoms) {
  for (auto& x : x_) x.resize(12 * std::size_t(clusters));
  for (auto& steps : steps_)
    if (steps.cols() != atoms) steps.setZero(3, atoms);
}

bool AtomTracks::are_at(const Vectors& x, const AtomClusters& clusters) const {
  for (int slot = 0; slot < clusters.slots(); ++slot)
    for (int d = 0; d < 3; ++d)
      if (x_[0][entry(slot, d)] != x(d, clusters.atom(slot)) + clusters.offset(slot)[d]) return false;
  return true;
}

void AtomTracks::advance() {
  x_[2].swap(x_[1]);
  x_[1].swap(x_[0]);
  known_ = std::min(known_ + 1, 2);
}

void AtomTracks::follow(const Eigen::Matrix3d& map, const Share& clusters) {
  for (auto& x : x_)
    for (int c = clusters.begin; c < clusters.end; ++c) {
      Eigen::Map<Eigen::Matrix<double, 4, 3>> four(x.data() + entry(4 * std::ptrdiff_t{c}, 0));
      four *= map.transpose();
    }
}

void AtomTracks::leave(const AtomClusters& clusters, const Share& share) {
  for (int k = 0; k < 2; ++k)
    for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot)
      for (int d = 0; d < 3; ++d) {
        const std::ptrdiff_t at = entry(slot, d);
        steps_[k](d, clusters.atom(slot)) = x_[k][at] - x_[k + 1][at];
      }
}

void AtomTracks::enter(const AtomClusters& clusters, const Share& share) {
  for (int k = 0; k < 2; ++k)
    for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot)
      for (int d = 0; d < 3; ++d) {
        const std::ptrdiff_t at = entry(slot, d);
        x_[k + 1][at] = x_[k][at] - steps_[k](d, clusters.atom(slot));
      }
}

double AtomTracks::look_ahead(const Aim& aim, const Share& clusters, RoundedPositions& list) const {
  const double T = known_ == 2 ? ahead_ : 0;
  const Course course{{x_[0].data(), x_[1].data(), x_[2].data()},
                      {1.5 * T + 0.5 * T * T, -2 * T - T * T, 0.5 * T + 0.5 * T * T},
                      0.4 * aim.most_from_search,
                      known_ == 2 ? aim.spare : aim.unknown(),
                      aim.unknown()};
  return HWY_DYNAMIC_DISPATCH(look_ahead_simd)(course, clusters, list.x.data());
}

void AtomTracks::adjust(double half_ways, const Aim& aim) {
  const double mean = half_ways / (double(x_[0].size()) / 3);
  if (mean > 0) ahead_ = std::min(ahead_ * aim.way / mean, kFarthest);
}

bool AtomTracks::covers_all(const RoundedPositions& list, const Share& clusters) const {
  return HWY_DYNAMIC_DISPATCH(covers_all_simd)(x_[0].data(), list.x.data(), clusters);
}

double farthest(const RoundedPositions& searched, const Share& clusters, const RoundedPositions& list,
                std::vector<double>& each) {
  return HWY_DYNAMIC_DISPATCH(farthest_simd)(searched.x.data(), clusters, list.x.data(), each.data());
}

void AtomTracks::serialize(Archive& archive) {
  archive(x_[0], x_[1], known_, ahead_);
  archive.demand(0 <= known_ && known_ <= 2 && 0 < ahead_ && ahead_ <= kFarthest);
}

}  // namespace taut
#endif
