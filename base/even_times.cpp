#include "base/even_times.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace taut {
namespace {

constexpr double kAlike =
    0.01;  // spacings differ by less than this share of them: times are sums of many steps

bool alike(double a, double b) {
  return std::abs(a - b) <= kAlike * std::max(a, b);
}

std::vector<double> gaps_of(std::span<const double> t) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < t.size(); ++k) gaps.push_back(t[k] - t[k - 1]);
  return gaps;
}

bool are_even(std::span<const double> gaps) {
  return std::ranges::all_of(gaps, [&](double gap) { return alike(gap, gaps[0]); });
}

EvenPart part_of(std::vector<std::size_t> samples, std::span<const double> t) {
  EvenPart part{.samples = std::move(samples)};
  if (part.samples.size() > 1)
    part.interval =
        (t[part.samples.back()] - t[part.samples.front()]) / static_cast<double>(part.samples.size() - 1);
  return part;
}

double length_of(const EvenPart& part) {
  return part.samples.empty() ? 0 : part.interval * static_cast<double>(part.samples.size() - 1);
}

// The spacings in which most time is spent, a few of them.
std::vector<double> main_spacings(std::vector<double> gaps) {
  constexpr std::size_t kMost = 8;
  struct Spacing {
    double gap, time;
  };
  std::vector<Spacing> all;
  std::ranges::sort(gaps);
  for (const double gap : gaps)
    if (!all.empty() && alike(all.back().gap, gap))
      all.back().time += gap;
    else
      all.push_back({gap, gap});
  std::ranges::sort(all, std::greater{}, &Spacing::time);
  std::vector<double> spacings;
  for (std::size_t k = 0; k < std::min(kMost, all.size()); ++k) spacings.push_back(all[k].gap);
  return spacings;
}

// The most samples that follow each other at this spacing.
std::vector<std::size_t> longest_chain(std::span<const double> t, double spacing) {
  std::vector<std::size_t> next(t.size()), count(t.size(), 1);
  std::size_t first = t.size() - 1;
  for (std::size_t k = t.size(), j = t.size(); k-- > 0;) {
    while (j > 0 && t[j - 1] > t[k] + spacing * (1 - kAlike)) --j;
    next[k] = j;
    if (j > k && j < t.size() && t[j] < t[k] + spacing * (1 + kAlike)) count[k] = 1 + count[j];
    if (count[k] >= count[first]) first = k;
  }
  std::vector<std::size_t> chain = {first};
  for (std::size_t left = count[first] - 1; left > 0; --left) chain.push_back(next[chain.back()]);
  return chain;
}

}  // namespace

std::vector<EvenPart> even_parts(std::span<const double> t) {
  constexpr int kMostFactor = 16;
  constexpr double kHardlyLonger = 0.9;
  const std::vector<double> gaps = gaps_of(t);
  if (are_even(gaps)) {
    std::vector<std::size_t> all(t.size());
    std::iota(all.begin(), all.end(), 0);
    return {part_of(std::move(all), t)};
  }
  std::vector<EvenPart> tried;
  for (const double spacing : main_spacings(gaps))
    for (int factor = 1; factor <= kMostFactor; ++factor)
      tried.push_back(part_of(longest_chain(t, factor * spacing), t));
  std::ranges::stable_sort(tried, [](const EvenPart& a, const EvenPart& b) {
    return length_of(a) != length_of(b) ? length_of(a) > length_of(b) : a.samples.size() > b.samples.size();
  });
  std::vector<EvenPart> parts;
  for (const EvenPart& part : tried) {
    const bool better = std::ranges::any_of(tried, [&](const EvenPart& other) {
      return other.samples.size() > part.samples.size() &&
             length_of(other) >= kHardlyLonger * length_of(part);
    });
    if (!better && (parts.empty() || part.samples.size() > parts.back().samples.size()))
      parts.push_back(part);
  }
  return parts;
}

std::vector<double> spans_of(std::span<const double> t) {
  constexpr double kHole = 1.5;
  if (t.size() < 2) return std::vector<double>(t.size(), 1.0);
  const std::vector<double> gaps = gaps_of(t);
  std::vector<double> spans = {gaps[0]};
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    const double before = k > 0 ? gaps[k - 1] : 0, after = k + 1 < gaps.size() ? gaps[k + 1] : 0;
    const bool hole = after > 0 && gaps[k] > kHole * std::max(before, after);
    spans.push_back(hole ? after : gaps[k]);
    if (k == 0 && hole) spans[0] = after;
  }
  return spans;
}

EvenMeans::EvenMeans(std::span<const double> t) : samples_(t.size()) {
  constexpr double kRounding = 1e-6;           // of an interval
  constexpr double kFilled = 0.5 - kRounding;  // what is known of less of an interval joins the next one
  if (are_even(gaps_of(t))) return;
  const std::vector<double> spans = spans_of(t);
  std::vector<double> sorted = spans;
  std::ranges::sort(sorted);
  const double all = std::accumulate(spans.begin(), spans.end(), 0.0);
  double width = sorted.back(), spent = 0;
  for (const double span : sorted)
    if (spent += span; spent >= all / 2) {
      width = span;
      break;
    }
  const double begin = t[0] - width;
  double last = -1, filled = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const double to = (t[k] - begin) / width, from = std::max(0.0, to - spans[k] / width);
    for (double interval = std::floor(from + kRounding); interval < to - kRounding; ++interval) {
      if (interval > last && (last < 0 || filled >= kFilled)) ++intervals_, filled = 0;
      last = interval;
      const double share = std::min(to, interval + 1) - std::max(from, interval);
      shares_.push_back({intervals_ - 1, k, share});
      filled += share;
    }
  }
  if (filled < kFilled && intervals_ > 1) {
    --intervals_;
    for (Share& share : shares_) share.interval = std::min(share.interval, intervals_ - 1);
  }
}

std::vector<double> EvenMeans::of(std::span<const double> y) const {
  if (shares_.empty()) return {y.begin(), y.end()};  // even times: one sample an interval
  std::vector<double> sum(intervals_, 0.0), time(intervals_, 0.0);
  for (const auto& [interval, sample, share] : shares_) {
    sum[interval] += share * y[sample];
    time[interval] += share;
  }
  for (std::size_t k = 0; k < intervals_; ++k) sum[k] /= time[k];
  return sum;
}

std::size_t EvenMeans::first_sample(std::size_t interval) const {
  if (shares_.empty()) return std::min(interval, samples_);  // even times: one sample an interval
  const auto at = std::ranges::lower_bound(shares_, interval, {}, &Share::interval);
  return at == shares_.end() ? samples_ : at->sample;
}

}  // namespace taut
