#include "forcefield/pme/pme.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "md/shares.hpp"
#include "md/units.hpp"

namespace taut {
namespace {
constexpr int kPairsOfPiece = 256;   // summed together, on however many threads
constexpr int kPairsOfThread = 512;  // fewer are not worth waking a thread for
}  // namespace

Pme::Pme(const Nonbonded& nb, Precision precision)
    : alpha_(nb.pme->alpha),
      screening_(alpha_, *nb.cutoff, {.error = 1e-15}),
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

void Pme::add_forces(const Vectors& x, Vectors& f) {
  mesh_.add_forces(x, f);
  subtract_excluded(x, f);
}

void Pme::subtract_excluded(const Vectors& x, Vectors& f) {
  const int pieces = static_cast<int>(cuts_.size()) - 1;
  pieces_.resize(pieces);
  const int threads = threads_for(static_cast<int>(excluded_.size()), kPairsOfThread);
  in_parallel(threads, [&](int t) {
    const Share share(pieces, t, threads);
    for (int p = share.begin; p < share.end; ++p)
      pieces_[p] = subtract({excluded_.begin() + cuts_[p], excluded_.begin() + cuts_[p + 1]}, x, f);
  });
  excluded_sums_ = {};
  for (const ExcludedSums& piece : pieces_) {
    excluded_sums_.energy += piece.energy;
    excluded_sums_.virial += piece.virial;
  }
}

Pme::ExcludedSums Pme::subtract(std::span<const Excluded> excluded, const Vectors& x, Vectors& f) const {
  ExcludedSums sums;
  for (std::size_t first = 0; first < excluded.size(); first += kScreenedPairs) {
    const auto some = excluded.subspan(first, std::min<std::size_t>(excluded.size() - first, kScreenedPairs));
    ScreenedPairs pairs;
    for (std::size_t k = 0; k < some.size(); ++k)
      pairs.r2[k] = (x.col(some[k].i) - x.col(some[k].j)).squaredNorm();
    screen(screening_, pairs);
    for (std::size_t k = 0; k < some.size(); ++k) {
      const auto& [i, j, qq] = some[k];
      const Vec3 r = x.col(i) - x.col(j), pull = qq * pairs.force[k] * r;
      sums.energy -= qq * pairs.energy[k];
      sums.virial -= r * pull.transpose();
      f.col(i) -= pull;
      f.col(j) += pull;
    }
  }
  return sums;
}

}  // namespace taut
