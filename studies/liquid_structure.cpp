#include "studies/liquid_structure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "systems/whole_molecules.hpp"

namespace taut {
namespace {

// The oxygen of a water, −1 for any other molecule: three atoms, each bonded to both others, one of 15 to 17
// u.
int oxygen_of(const std::vector<int>& atoms, const std::vector<int>& degree, const System& sys) {
  if (atoms.size() != 3) return -1;
  int oxygen = -1;
  for (const int a : atoms) {
    if (degree[a] != 2) return -1;
    if (sys.mass[a] > 15 && sys.mass[a] < 17) oxygen = a;
  }
  return oxygen;
}

// The two ends of an unbranched chain, none for any other molecule.
std::vector<int> ends_of(const std::vector<int>& atoms, const std::vector<int>& degree) {
  std::vector<int> ends;
  for (const int a : atoms) {
    if (degree[a] == 1) ends.push_back(a);
    if (degree[a] > 2) return {};
  }
  return atoms.size() > 2 && ends.size() == 2 ? ends : std::vector<int>{};
}

}  // namespace

LiquidStructure::LiquidStructure(const System& sys, const Terms& terms, const Box& box) {
  const std::vector<BondedPair> pairs = bonded_pairs(sys, terms);
  std::vector<int> degree(sys.atoms(), 0);
  for (const auto& [i, j] : pairs) ++degree[i], ++degree[j];
  const std::vector<int> molecule = molecules(sys.atoms(), pairs);
  std::vector<std::vector<int>> atoms;
  for (int a = 0; a < sys.atoms(); ++a) {
    atoms.resize(std::max<std::size_t>(atoms.size(), molecule[a] + 1));
    atoms[molecule[a]].push_back(a);
  }
  for (const auto& members : atoms) {
    if (const int oxygen = oxygen_of(members, degree, sys); oxygen >= 0 && box.periodic())
      oxygens_.push_back(oxygen);
    if (const std::vector<int> ends = ends_of(members, degree); !ends.empty())
      ends_.push_back({ends[0], ends[1]});
  }
  if (has_water()) reach_ = std::min(1.0, box.edge.minCoeff() / 2);
}

void LiquidStructure::see(const State& s) {
  const Vectors& x = s.x;
  if (has_chains()) {
    double sum = 0;
    for (const auto& [i, j] : ends_) sum += (x.col(j) - x.col(i)).squaredNorm();
    r_squared_.push_back(sum / static_cast<double>(ends_.size()));
  }
  if (!has_water()) return;
  std::vector<double> count(static_cast<std::size_t>(reach_ / kBin), 0.0);
  for (std::size_t p = 0; p < oxygens_.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      const double r = s.box.nearest_image(x.col(oxygens_[p]) - x.col(oxygens_[q])).norm();
      if (const auto bin = static_cast<std::size_t>(r / kBin); bin < count.size())
        count[bin] += s.box.volume();
    }
  counts_.push_back(std::move(count));
}

// g = pairs seen / pairs of an ideal gas, N(N−1)/2 · ⁴⁄₃π(r₊³ − r₋³)/V
Distances LiquidStructure::oxygen_distances() const {
  Distances d;
  if (counts_.empty()) return d;
  const double n = static_cast<double>(oxygens_.size()), pairs = n * (n - 1) / 2;
  for (std::size_t bin = 0; bin < counts_[0].size(); ++bin) {
    const double low = kBin * static_cast<double>(bin), high = low + kBin;
    const double ideal = pairs * 4 / 3 * std::numbers::pi * (std::pow(high, 3) - std::pow(low, 3));
    std::vector<double> g;
    for (const auto& row : counts_) g.push_back(row[bin] / ideal);
    d.r.push_back(low + kBin / 2);
    d.g.push_back(block_mean(g));
  }
  return d;
}

// √ of the mean, its error by the slope of √
Estimate LiquidStructure::end_to_end() const {
  const Estimate squared = block_mean(r_squared_);
  const double root = std::sqrt(squared.value);
  return {root, root > 0 ? squared.error / (2 * root) : 0.0};
}

}  // namespace taut
