#include "forcefield/clusters/atom_tracks.hpp"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

constexpr double kFarthest = 100;  // T

}  // namespace

void AtomTracks::make_room(int clusters, Eigen::Index atoms) {
  for (auto& x : x_) x.resize(12 * std::size_t(clusters));
  for (auto& steps : steps_)
    if (steps.cols() != atoms) steps.setZero(3, atoms);
}

bool AtomTracks::stand_at(const Vectors& x, const AtomClusters& clusters) const {
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

void AtomTracks::leave(const AtomClusters& clusters, const Share& share) {
  for (int k = 0; k < 2; ++k)
    for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot)
      for (int d = 0; d < 3; ++d) {
        const std::size_t at = entry(slot, d);
        steps_[k](d, clusters.atom(slot)) = x_[k][at] - x_[k + 1][at];
      }
}

void AtomTracks::enter(const AtomClusters& clusters, const Share& share) {
  for (int k = 0; k < 2; ++k)
    for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot)
      for (int d = 0; d < 3; ++d) {
        const std::size_t at = entry(slot, d);
        x_[k + 1][at] = x_[k][at] - steps_[k](d, clusters.atom(slot));
      }
}

// An atom of which nothing is known yet, or that seems to go too far, as after a jump, may go anywhere.
double AtomTracks::look_ahead(const Aim& aim, const Share& clusters, RoundedPositions& list) const {
  const double farthest = 0.4 * aim.reach, wide = 2 * (aim.way + aim.spare), T = ahead_;
  const double now = 1.5 * T + 0.5 * T * T, before = -2 * T - T * T, long_before = 0.5 * T + 0.5 * T * T;
  double half_ways = 0;
  for (int c = clusters.begin; c < clusters.end; ++c) {
    const double *x = x_[0].data() + 12 * c, *x1 = x_[1].data() + 12 * c, *x2 = x_[2].data() + 12 * c;
    float* to = list.x.data() + 16 * c;
    for (int i = 0; i < 4; ++i) {
      double way[3], way2 = 0, off2 = 0;
      for (int d = 0; d < 3; ++d) {
        const int k = 4 * d + i;
        way[d] = now * x[k] + before * x1[k] + long_before * x2[k];
        way2 += way[d] * way[d];
      }
      const double half = 0.5 * std::sqrt(way2);
      const bool goes = known_ == 2 && half <= farthest;
      for (int d = 0; d < 3; ++d) {
        const int k = 4 * d + i;
        to[k] = static_cast<float>(x[k] + (goes ? 0.5 * way[d] : 0));
        const double off = double(to[k]) - x[k];
        off2 += off * off;
      }
      to[12 + i] = static_cast<float>(std::sqrt(off2) + (goes ? aim.spare : wide));
      half_ways += goes ? half : 0;
    }
  }
  return half_ways;
}

void AtomTracks::adjust(double half_ways, const Aim& aim) {
  const double mean = half_ways / (double(x_[0].size()) / 3);
  if (mean > 0) ahead_ = std::min(ahead_ * aim.way / mean, kFarthest);
}

bool AtomTracks::served(const RoundedPositions& list, const Share& clusters) const {
  bool all = true;
  for (int c = clusters.begin; c < clusters.end; ++c) {
    const double* x = x_[0].data() + 12 * c;
    const float* there = list.x.data() + 16 * c;
    for (int i = 0; i < 4; ++i) {
      const double dx = x[i] - double(there[i]), dy = x[i + 4] - double(there[i + 4]),
                   dz = x[i + 8] - double(there[i + 8]), margin = there[i + 12];
      all &= dx * dx + dy * dy + dz * dz <= margin * margin;  // false for NaN
    }
  }
  return all;
}

bool within_reach(double reach, const RoundedPositions& searched, const Share& clusters,
                  const RoundedPositions& list) {
  bool all = true;
  for (int c = clusters.begin; c < clusters.end; ++c) {
    const float *x = list.x.data() + 16 * c, *then = searched.x.data() + 16 * c;
    for (int i = 0; i < 4; ++i) {
      const double dx = double(x[i]) - double(then[i]), dy = double(x[i + 4]) - double(then[i + 4]),
                   dz = double(x[i + 8]) - double(then[i + 8]);
      all &= std::sqrt(dx * dx + dy * dy + dz * dz) + double(x[i + 12]) <= reach;  // false for NaN
    }
  }
  return all;
}

void AtomTracks::serialize(Archive& archive) {
  archive(x_[0], x_[1], known_, ahead_);
  archive.demand(0 <= known_ && known_ <= 2 && 0 < ahead_ && ahead_ <= kFarthest);
}

}  // namespace taut
