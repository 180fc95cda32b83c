#include "measures/measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/series.hpp"

namespace taut {
namespace {

// Atoms in cells of a box, none narrower than `reach`: all within reach of a place are in the cell there and
// the 26 about it.
class Cells {
 public:
  Cells(const Box& box, double reach) : inverse_(box.vectors().inverse()) {
    for (int d = 0; d < 3; ++d) n_[d] = static_cast<long>(1 / (inverse_.row(d).norm() * reach));
  }
  bool serve() const { return n_.minCoeff() >= 3; }  // else a cell is about itself

  void fill(const Vectors& x, const std::vector<int>& atoms) {
    cells_.resize(static_cast<std::size_t>(n_.prod()));
    for (const int a : atoms) cells_[at(of(x.col(a)))].push_back(a);
  }
  void for_each_near(const Vec3& x, auto&& act) const {
    const Cell middle = of(x);
    for (int k = 0; k < 27; ++k)
      for (const int a : cells_[at(middle + Cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1))]) act(a);
  }

 private:
  using Cell = Eigen::Array<long, 3, 1>;

  Cell of(const Vec3& x) const {
    const Eigen::Array3d part = (inverse_ * x).array();
    return ((part - part.floor()) * n_.cast<double>()).cast<long>();
  }
  std::size_t at(const Cell& cell) const {
    const Cell c = cell - (cell >= n_).select(n_, 0) + (cell < 0).select(n_, 0);
    return static_cast<std::size_t>((c[2] * n_[1] + c[1]) * n_[0] + c[0]);
  }

  Eigen::Matrix3d inverse_;
  Cell n_;
  std::vector<std::vector<int>> cells_;
};

}  // namespace

RadialDistribution::RadialDistribution(std::vector<int> a, std::vector<int> b, std::vector<int> molecule,
                                       double reach)
    : a_(std::move(a)),
      b_(std::move(b)),
      molecule_(std::move(molecule)),
      alike_(a_ == b_),
      reach_(reach),
      pairs_(pairs()) {}

bool RadialDistribution::counts(int i, int j) const {
  return molecule_[i] != molecule_[j] && (!alike_ || j < i);
}

// All, without those of one molecule.
double RadialDistribution::pairs() const {
  std::map<int, double> here;  // atoms of b in a molecule
  for (const int j : b_) ++here[molecule_[j]];
  double all = 0;
  for (const int i : a_) {
    const auto own = here.find(molecule_[i]);
    all += static_cast<double>(b_.size()) - (own == here.end() ? 0 : own->second);
  }
  return alike_ ? all / 2 : all;
}

void RadialDistribution::see(double t, const Vectors& x, const Box& box) {
  std::vector<double> count(static_cast<std::size_t>(reach_ / kBin), 0.0);
  const auto add = [&](int i, int j) {
    if (!counts(i, j)) return;
    const double r = box.nearest_image(x.col(i) - x.col(j)).norm();
    if (const auto bin = static_cast<std::size_t>(r / kBin); bin < count.size()) count[bin] += box.volume();
  };
  Cells cells(box, reach_);
  if (cells.serve()) cells.fill(x, b_);
  for (const int i : a_)
    if (cells.serve())
      cells.for_each_near(x.col(i), [&](int j) { add(i, j); });
    else
      for (const int j : b_) add(i, j);
  t_.push_back(t);
  counts_.push_back(std::move(count));
}

Distances RadialDistribution::result() const {
  Distances d;
  if (counts_.empty()) return d;
  const EvenMeans even(t_);
  for (std::size_t bin = 0; bin < counts_[0].size(); ++bin) {
    const double low = kBin * static_cast<double>(bin), high = low + kBin;
    const double ideal = pairs_ * 4 / 3 * std::numbers::pi * (std::pow(high, 3) - std::pow(low, 3));
    std::vector<double> g;
    for (const auto& row : counts_) g.push_back(row[bin] / ideal);
    d.r.push_back(low + kBin / 2);
    d.g.push_back(block_mean(even.of(g)));
  }
  return d;
}

void EndToEnd::see(double t, const Vectors& x) {
  double sum = 0;
  for (std::size_t c = 0; c < ends_.size(); ++c) {
    const double squared = (x.col(ends_[c][1]) - x.col(ends_[c][0])).squaredNorm();
    sum += squared;
    of_chain_[c] += squared;
  }
  t_.push_back(t);
  squared_.push_back(sum / static_cast<double>(ends_.size()));
}

Estimate EndToEnd::squared() const {
  const Estimate of_frames = block_mean(EvenMeans(t_).of(squared_));
  const double of_chains =
      independent_mean(of_chain_).error / static_cast<double>(std::max<std::size_t>(squared_.size(), 1));
  return {of_frames.value, std::max(of_frames.error, of_chains)};
}

// √ of the mean, its error by the slope of √
Estimate EndToEnd::root() const {
  const Estimate of = squared();
  const double root = std::sqrt(of.value);
  return {root, root > 0 ? of.error / (2 * root) : 0.0};
}

EvenPart frames_to_follow(const std::vector<double>& t) {
  std::vector<EvenPart> parts = even_parts(t);
  const auto enough = std::ranges::find_if(
      parts, [](const EvenPart& part) { return part.samples.size() >= kFramesToFollow; });
  return std::move(enough == parts.end() ? parts.back() : *enough);
}

void MeanSquareDisplacement::see(double t, const Vectors& x) {
  const int molecules = *std::ranges::max_element(molecule_) + 1;
  Vectors centre = Vectors::Zero(3, molecules);
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(molecules);
  for (Eigen::Index a = 0; a < x.cols(); ++a) {
    centre.col(molecule_[a]) += mass_[a] * x.col(a);
    whole[molecule_[a]] += mass_[a];
  }
  for (int m = 0; m < molecules; ++m)
    if (whole[m] > 0) centre.col(m) /= whole[m];
  t_.push_back(t);
  centres_.push_back(std::move(centre));
}

MeanSquareDisplacement::Result MeanSquareDisplacement::result() const {
  constexpr std::size_t kMostLags = 50, kMostOrigins = 100;
  Result result;
  result.frames = frames_to_follow(t_);
  const std::vector<std::size_t>& frames = result.frames.samples;
  const std::size_t block = frames.size() / kBlocks, furthest = block / 2;
  if (furthest < 2) return result;
  const auto centres = [&](std::size_t frame) -> const Vectors& { return centres_[frames[frame]]; };
  const std::size_t lag_step = std::max<std::size_t>(1, furthest / kMostLags);
  const std::size_t origin_step = std::max<std::size_t>(1, (block - furthest) / kMostOrigins);
  std::vector<std::size_t> lags;
  for (std::size_t lag = lag_step; lag <= furthest; lag += lag_step) lags.push_back(lag);

  std::vector<std::vector<double>> squared(lags.size());  // of each lag: of each block
  std::vector<double> slopes;
  for (std::size_t first = 0; first + block <= frames.size(); first += block) {
    Slope upper;
    for (std::size_t k = 0; k < lags.size(); ++k) {
      double sum = 0, samples = 0;
      for (std::size_t o = first; o + lags[k] < first + block; o += origin_step, ++samples)
        sum += (centres(o + lags[k]) - centres(o)).squaredNorm() / static_cast<double>(centres(o).cols());
      squared[k].push_back(sum / samples);
      if (2 * lags[k] >= furthest)
        upper.add(result.frames.interval * static_cast<double>(lags[k]), squared[k].back());
    }
    slopes.push_back(upper.value());
  }
  for (std::size_t k = 0; k < lags.size(); ++k) {
    result.t.push_back(result.frames.interval * static_cast<double>(lags[k]));
    result.squared.push_back(independent_mean(squared[k]));
  }
  const auto half = std::ranges::lower_bound(result.t, result.t.back() / 2) - result.t.begin();
  if (const double before = result.squared[static_cast<std::size_t>(half)].value; before > 0)
    result.exponent = std::log(result.squared.back().value / before) /
                      std::log(result.t.back() / result.t[static_cast<std::size_t>(half)]);
  const Estimate slope = independent_mean(slopes);
  result.diffusion = {slope.value / 6, slope.error / 6};
  return result;
}

}  // namespace taut
