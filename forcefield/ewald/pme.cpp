#include "forcefield/ewald/pme.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "md/step_parts.hpp"

namespace taut {
namespace {
constexpr int kPairsOfPiece = 256;    // summed together, on however many threads
constexpr int kPairsOfThread = 512;   // fewer are not worth waking a thread for
constexpr double kMixedError = 1e-8;  // of erf(αr)/r, where the mesh has 1e-7 of its own
}  // namespace

Pme::Pme(const Nonbonded& nb, Precision precision, std::vector<Reach> reach)
    : alpha_(nb.pme->alpha),
      screening_(alpha_, *nb.cutoff, {.error = precision == Precision::kMixed ? kMixedError : 1e-15}),
      reach_(std::move(reach)),
      total_(nb.charge.sum()),
      constant_(-nb.coulomb() * alpha_ / std::sqrt(std::numbers::pi) * nb.charge.squaredNorm()),
      coulomb_(nb.coulomb()),
      mesh_(std::sqrt(nb.coulomb()) * nb.charge, *nb.pme, precision) {
  for (const auto& e : nb.exceptions)
    if (const double qq = nb.charge[e.i] * nb.charge[e.j]; qq != 0)
      excluded_.push_back({e.i, e.j, nb.coulomb() * qq});
  std::ranges::stable_sort(excluded_, kByLowestAtom);
  cuts_ = Pieces({excluded_.begin(), excluded_.end()}, kPairsOfPiece);
  start_ = cuts_.starts_of(excluded_);
  sum_of_.resize(cuts_.count());
}

void Pme::set_box(const Box& box) {
  background_ = -coulomb_ * std::numbers::pi * total_ * total_ / (2 * box.volume() * alpha_ * alpha_);
  mesh_.set_box(box);
  box_ = box;
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
  cuts_.for_each(kPairsOfThread, [&](int piece) {
    ExcludedSums& sum = sum_of_[piece] = {};
    for (int first = start_[piece], end = start_[piece + 1]; first < end; first += kScreenedPairs)
      sum += over_some(std::span(excluded_).subspan(first, std::min(end - first, kScreenedPairs)), x, add);
  });
  return std::accumulate(sum_of_.begin(), sum_of_.end(), ExcludedSums());
}

Pme::ExcludedSums Pme::over_some(std::span<const Excluded> excluded, const Vectors& x,
                                 const auto& add) const {
  ScreenedPairs pairs;
  Vec3 r[kScreenedPairs];
  for (std::size_t k = 0; k < excluded.size(); ++k) {
    r[k] = x.col(excluded[k].i) - x.col(excluded[k].j);
    if (!reach_.empty()) r[k] = within_molecule(reach_[excluded[k].i], box_, r[k]);
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
