#include "systems/openmm/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {
namespace {

using Values = Expression::Values;
using Rough = Expression::Rough;
using Ways = Expression::Ways;

constexpr double kNear = 1e-3, kFar = 1e4;  // [nm] of coordinates, where nothing else bounds them
constexpr double kFarParameter = 1e3;
constexpr int kDraws = 24;       // of the parameters
constexpr int kPlaces = 24;      // along a line, besides those beside numbers
constexpr int kMostTurns = 400;  // points that narrow down the turns along a line
constexpr int kLeastCompared = 6;

// Returns the value at a share from 0 to 1 of a range: of its logarithm where it is wide, to both sides of 0 if it
// goes there.
double at_share(const Quantity& q, double share, double far) {
  if (q.high - q.low < 10) return q.low + share * (q.high - q.low);
  const double sign = q.low < 0 && share < 0.5 ? -1 : 1;
  if (q.low < 0) share = std::abs(2 * share - 1);
  return sign * kNear * std::pow(std::min(far, q.high) / kNear, share);
}

// Compares two energies at single points, and keeps which ways their branches went.
class Comparison {
 public:
  Comparison(const Expression& energy, const Domain& domain, const Reference& reference)
      : energy_(energy), domain_(domain), reference_(reference) {}

  // Returns false where the energies differ.
  bool agree_at(const Values& at) {
    const Rough given = energy_.probe(at, ways_), other = reference_(at, of_reference_);
    ways_.insert(ways_.end(), of_reference_.begin(), of_reference_.end());
    if (!other.decided()) return true;
    seen_.resize(ways_.size(), {Expression::kUndecided, false});
    for (std::size_t b = 0; b < ways_.size(); ++b) {
      if (ways_[b] == Expression::kUndecided) continue;
      auto& [first, another] = seen_[b];
      if (first == Expression::kUndecided) first = ways_[b];
      another |= ways_[b] != first;
    }
    if (!given.decided()) return true;
    if (!std::isfinite(other.value)) return !std::isfinite(given.value);
    ++compared_;
    return same(given, other);
  }

  const Ways& ways() const { return ways_; }
  bool complete() const {
    for (std::size_t b = 0; b < seen_.size(); ++b) {
      const bool turns =
          b >= energy_.branches().size() ||
          std::ranges::any_of(energy_.branches()[b], [&](const auto& name) { return varies(name); });
      if (turns && !seen_[b].second) return false;
    }
    return compared_ >= kLeastCompared;
  }

 private:
  bool varies(const std::string& name) const {
    const auto fixed = std::ranges::find(domain_.parameters, name, &Quantity::name);
    return fixed == domain_.parameters.end() || fixed->low < fixed->high;
  }

  const Expression& energy_;
  const Domain& domain_;
  const Reference& reference_;
  Ways ways_, of_reference_;
  std::vector<std::pair<int, bool>> seen_;  // of each branch its first way, and whether it went another one
  int compared_ = 0;
};

// A line along one coordinate.
class Line {
 public:
  Line(Comparison& comparison, Values& at, const Quantity& along)
      : comparison_(comparison), at_(at), along_(along), kept_(at[along.name]) {}
  ~Line() { at_[along_.name] = kept_; }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  // Compares at places all over the range, and at and right beside the numbers that stand in the energies, where
  // branches may turn; then between neighbours whose branches differ.
  bool agree(const std::vector<double>& numbers, Random& random) {
    std::vector<double> places;
    for (int k = 0; k < kPlaces; ++k)
      places.push_back(at_share(along_, (k + random.uniform()) / kPlaces, kFar));
    for (const double number : numbers)
      for (const double beside : {1 - 1e-4, 1.0, 1 + 1e-4})
        if (const double place = number * beside; place >= along_.low && place <= along_.high)
          places.push_back(place);
    std::ranges::sort(places);
    Ways before;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!agree_at(places[k])) return false;
      const Ways here = comparison_.ways();
      if (k > 0 && here != before && !agree_between(places[k - 1], before, places[k], here)) return false;
      before = here;
    }
    return true;
  }

 private:
  bool agree_at(double place) {
    at_[along_.name] = place;
    return comparison_.agree_at(at_);
  }

  // Halves the way between two points whose branches differ, as long as they are apart.
  bool agree_between(double low, const Ways& of_low, double high, const Ways& of_high) {
    if (high - low < 1e-7 * std::max(std::abs(low), std::abs(high)) || ++turns_ > kMostTurns) return true;
    const double middle = low > 0 && high > 4 * low    ? std::sqrt(low * high)
                          : high < 0 && low < 4 * high ? -std::sqrt(low * high)
                                                       : low + (high - low) / 2;
    if (!agree_at(middle)) return false;
    const Ways here = comparison_.ways();
    return (here == of_low || agree_between(low, of_low, middle, here)) &&
           (here == of_high || agree_between(middle, here, high, of_high));
  }

  Comparison& comparison_;
  Values& at_;
  const Quantity& along_;
  double kept_;
  int turns_ = 0;
};

}  // namespace

double drawn(const Quantity& q, Random& random, double far) {
  return q.low == q.high ? q.low : at_share(q, random.uniform(), far);
}

bool same(const Expression::Rough& a, const Expression::Rough& b) {
  return std::abs(a.value - b.value) <= 4 * (a.error + b.error);
}

bool agree_everywhere(const Expression& energy, const Domain& domain, const Reference& reference) {
  Comparison comparison(energy, domain, reference);
  Random random(1);
  const bool one_line =
      domain.coordinates.size() == 1 &&
      std::ranges::all_of(domain.parameters, [](const Quantity& q) { return q.low == q.high; });
  for (int draw = 0; draw < (one_line ? 1 : kDraws); ++draw) {
    Values at;
    std::vector<double> numbers = energy.literals();
    numbers.push_back(0);
    for (const Quantity& q : domain.parameters)
      numbers.push_back(at[q.name] = drawn(q, random, kFarParameter));
    for (const Quantity& q : domain.coordinates) {  // often near a number, as a centre
      const double number =
          numbers[static_cast<std::size_t>(random.uniform() * static_cast<double>(numbers.size()))];
      const bool beside = random.uniform() < 0.5 && number >= q.low && number <= q.high;
      at[q.name] = beside ? number : drawn(q, random, kFar);
    }
    for (const Quantity& q : domain.coordinates)
      if (!Line(comparison, at, q).agree(numbers, random)) return false;
  }
  return comparison.complete();
}

}  // namespace taut
