#include "forcefield/ewald/pme.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/shares.hpp"
#include "md/step_parts.hpp"
#include "md/units.hpp"

namespace taut {
namespace {
constexpr int kPairsOfPiece = 256;    // summed together, on however many threads
constexpr int kPairsOfThread = 512;   // fewer are not worth waking a thread for
constexpr double kMixedError = 1e-8;  // of erf(αr)/r, where the mesh has 1e-7 of its own
}  // namespace

Pme::Pme(const Nonbonded& nb, Precision precision)
    : alpha_(nb.pme->alpha),
      screening_(alpha_, *nb.cutoff, {.error = precision == Precision::kMixed ? kMixedError : 1e-15}),
      total_(nb.charge.sum()),
      constant_(-kCoulomb * alpha_ / std::sqrt(std::numbers::pi) * nb.charge.squaredNorm()),
      mesh_(std::sqrt(kCoulomb) * nb.charge, *nb.pme, precision) {
  for (const auto& e : nb.exceptions)
    if (const double qq = nb.charge[e.i] * nb.charge[e.j]; qq != 0)
      excluded_.push_back({e.i, e.j, kCoulomb * qq});
  cut_excluded();
}

void Pme::cut_excluded() {
  const int n = static_cast<int>(excluded_.size());
  std::vector<int> lowest(n + 1, std::numeric_limits<int>::max());  // of this pair and all after it
  for (int k = n - 1; k >= 0; --k) lowest[k] = std::min({lowest[k + 1], excluded_[k].i, excluded_[k].j});
  for (int k = 0, highest = -1; k <= n; ++k) {
    const bool enough = k == 0 || k == n || k - cuts_.back() >= kPairsOfPiece;
    if (lowest[k] > highest && enough) cuts_.push_back(k);
    if (k < n) highest = std::max({highest, excluded_[k].i, excluded_[k].j});
  }
}

void Pme::set_box(const Box& box) {
  background_ = -kCoulomb * std::numbers::pi * total_ * total_ / (2 * box.volume() * alpha_ * alpha_);
  mesh_.set_box(box);
}

double Pme::add_forces(const Vectors& x, Vectors& f) {
  const double mesh = mesh_.add_forces(x, f);
  const auto add = [&f](ExcludedSums& sums, const Excluded& e, const Screened& s) {
    const Vec3 pull = e.qq * s.force * s.r;
    sums.energy -= e.qq * s.energy;
    f.col(e.i) -= pull;
    f.col(e.j) += pull;
  };
  const PartScope here(StepPart::kExclusions);
  return constant_ + background_ + over_excluded(x, add).energy + mesh;
}

Eigen::Matrix3d Pme::virial(const Vectors& x) {
  const auto add = [](ExcludedSums& sums, const Excluded& e, const Screened& s) {
    sums.virial -= e.qq * s.force * s.r * s.r.transpose();
  };
  return background_ * Eigen::Matrix3d::Identity() + over_excluded(x, add).virial + mesh_.virial(x);
}

Pme::ExcludedSums Pme::over_excluded(const Vectors& x, const auto& add) {
  const int pieces = static_cast<int>(cuts_.size()) - 1;
  pieces_.resize(pieces);
  const int threads = threads_for(static_cast<int>(excluded_.size()), kPairsOfThread);
  in_parallel(threads, [&](int t) {
    const Share share(pieces, t, threads);
    for (int p = share.begin; p < share.end; ++p) {
      pieces_[p] = {};
      for (int first = cuts_[p]; first < cuts_[p + 1]; first += kScreenedPairs)
        pieces_[p] += over_some(
            std::span(excluded_).subspan(first, std::min(cuts_[p + 1] - first, kScreenedPairs)), x, add);
    }
  });
  return std::accumulate(pieces_.begin(), pieces_.end(), ExcludedSums());
}

Pme::ExcludedSums Pme::over_some(std::span<const Excluded> excluded, const Vectors& x,
                                 const auto& add) const {
  ScreenedPairs pairs;
  Vec3 r[kScreenedPairs];
  for (std::size_t k = 0; k < excluded.size(); ++k) {
    r[k] = x.col(excluded[k].i) - x.col(excluded[k].j);
    pairs.r2[k] = r[k].squaredNorm();
  }
  std::fill(pairs.r2 + excluded.size(), std::end(pairs.r2), 0.0);
  screen(screening_, pairs);
  ExcludedSums sums;
  for (std::size_t k = 0; k < excluded.size(); ++k)
    add(sums, excluded[k], Screened{r[k], pairs.energy[k], pairs.force[k]});
  return sums;
}

}  // namespace taut
