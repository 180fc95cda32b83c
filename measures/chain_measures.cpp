#include "measures/chain_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/series.hpp"
#include "measures/liquid_structure.hpp"
#include "measures/measures.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {

std::vector<Chain> unbranched_chains(const System& sys, const Terms& terms) {
  std::vector<Chain> chains;
  const std::vector<int> molecule = molecules(sys, terms);
  std::vector<int> chain_of(sys.atoms(), -1);  // of each molecule
  for (const auto& [first, last] : chain_ends(sys, terms)) {
    chain_of[molecule[first]] = static_cast<int>(chains.size());
    Chain chain{.atoms = {}, .first = first, .last = last};
    for (const Pull& pull : terms.pulls) {
      if (pull.atom == last) chain.pull += pull.force / (sys.mass[first] > 0 ? 2 : 1);
      if (pull.atom == first) chain.pull -= pull.force / (sys.mass[last] > 0 ? 2 : 1);
    }
    chains.push_back(std::move(chain));
  }
  for (int a = 0; a < sys.atoms(); ++a)
    if (const int c = chain_of[molecule[a]]; c >= 0) chains[c].atoms.push_back(a);
  return chains;
}

ChainMeasures::ChainMeasures(std::vector<Chain> chains) : chains_(std::move(chains)) {
  for (const Chain& chain : chains_) pulled_ += chain.pull.norm() > 0;
}

double ChainMeasures::force() const {
  double sum = 0;
  for (const Chain& chain : chains_) sum += chain.pull.norm();
  return pulled_ > 0 ? sum / static_cast<double>(pulled_) : 0.0;
}

void ChainMeasures::Series::add(const std::vector<double>& each) {
  of_chain.resize(each.size());
  double sum = 0;
  for (std::size_t c = 0; c < each.size(); ++c) sum += each[c], of_chain[c] += each[c];
  of_frame.push_back(sum / static_cast<double>(each.size()));
}

Estimate ChainMeasures::Series::mean(const EvenMeans& even) const {
  if (of_frame.empty()) return {};
  const Estimate of_frames = correlated_mean(even.of(of_frame));
  const double of_chains = independent_mean(of_chain).error / static_cast<double>(of_frame.size());
  return {of_frames.value, std::max(of_frames.error, of_chains)};
}

void ChainMeasures::add_frame(double t, const Vectors& x) {
  t_.push_back(t);
  std::vector<double> squared, extended;
  Vectors ends(3, static_cast<Eigen::Index>(chains_.size()));
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const Chain& chain = chains_[c];
    const Vec3 r = x.col(chain.last) - x.col(chain.first);
    ends.col(static_cast<Eigen::Index>(c)) = r;
    Vec3 centre = Vec3::Zero();
    for (const int a : chain.atoms) centre += x.col(a);
    centre /= static_cast<double>(chain.atoms.size());
    double sum = 0;
    for (const int a : chain.atoms) sum += (x.col(a) - centre).squaredNorm();
    squared.push_back(sum / static_cast<double>(chain.atoms.size()));
    if (chain.pull.norm() > 0) extended.push_back(r.dot(chain.pull.normalized()));
  }
  gyration_.add(squared);
  if (!extended.empty()) extension_.add(extended);
  ends_.push_back(std::move(ends));
}

Estimate ChainMeasures::gyration_squared() const {
  return gyration_.mean(EvenMeans(t_));
}

Estimate ChainMeasures::extension() const {
  return extension_.mean(EvenMeans(t_));
}

namespace {

// The time at which a correlation falls to 1/e, between two lags as an exponential; 0 if it does not.
double time_to_fall(const std::vector<double>& t, const std::vector<double>& c) {
  const double fallen = std::exp(-1.0);
  for (std::size_t k = 1; k < c.size(); ++k) {
    if (c[k] > fallen) continue;
    if (c[k] <= 0) return t[k];
    const double share = (std::log(c[k - 1]) + 1) / (std::log(c[k - 1]) - std::log(c[k]));
    return t[k - 1] + share * (t[k] - t[k - 1]);
  }
  return 0;
}

}  // namespace

ChainMeasures::Relaxation ChainMeasures::relaxation() const {
  constexpr std::size_t kMostLags = 100;
  Relaxation result;
  result.frames = frames_to_follow(t_);
  const std::vector<std::size_t>& frames = result.frames.samples;
  if (frames.size() < kFramesToFollow) {
    result.flaw = fmt::format("{} {} are too few, it takes {}", frames.size(),
                              result.frames.whole(t_) ? "frames" : "evenly spaced frames", kFramesToFollow);
    return result;
  }
  // Ten groups: of chains where there are enough of them, or else of origins in time.
  const std::size_t furthest = frames.size() / 4, step = std::max<std::size_t>(1, furthest / kMostLags);
  const auto chains = static_cast<std::size_t>(ends_[0].cols()), origins = frames.size() - furthest;
  const bool by_chain = chains >= 2 * kBlocks;
  const auto group_of = [&](std::size_t chain, std::size_t origin) {
    return by_chain ? chain * kBlocks / chains : origin * kBlocks / origins;
  };
  std::vector<std::vector<double>> sums;
  for (std::size_t lag = 0; lag <= furthest; lag += step) {
    result.t.push_back(result.frames.interval * static_cast<double>(lag));
    std::vector<double> sum(kBlocks, 0.0);
    for (std::size_t o = 0; o < origins; ++o)
      for (std::size_t c = 0; c < chains; ++c) {
        const auto col = static_cast<Eigen::Index>(c);
        sum[group_of(c, o)] += ends_[frames[o]].col(col).dot(ends_[frames[o + lag]].col(col));
      }
    sums.push_back(std::move(sum));
  }
  std::vector<double> all, times;
  std::vector<std::vector<double>> of_group(kBlocks);
  for (const std::vector<double>& sum : sums) {
    double whole = 0, zero = 0;
    std::vector<double> each;
    for (std::size_t g = 0; g < kBlocks; ++g) {
      whole += sum[g], zero += sums[0][g];
      each.push_back(sum[g] / sums[0][g]);
      of_group[g].push_back(each.back());
    }
    all.push_back(whole / zero);
    result.correlation.push_back({all.back(), independent_mean(each).error});
  }
  const double time = time_to_fall(result.t, all);
  for (const std::vector<double>& c : of_group)
    if (const double fell = time_to_fall(result.t, c); fell > 0) times.push_back(fell);
  if (time == 0 || times.size() < kBlocks) {
    result.flaw = fmt::format("the ends have not turned: C = {:.2f} after {:.4g} ps, a quarter of the frames",
                              all.back(), result.t.back());
    return result;
  }
  result.time = {time, independent_mean(times).error};
  return result;
}

}  // namespace taut
