#include "systems/openmm/known.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace taut {
namespace {

constexpr int kPoints = 24;
constexpr std::size_t kMostDeclared = 8;  // of more, none is tried under another name than its own
// openmm.app writes π as 3.141593 in places; where energies vanish, the difference is taken against kNear.
constexpr double kTolerance = 3e-5, kNear = 0.1;

class Comparison {
 public:
  Comparison(const Expression& energy, const std::vector<std::string>& declared,
             const std::vector<Quantity>& coordinates, const KnownEnergy& known)
      : energy_(energy), known_energy_(known.text), known_(known), declared_(declared) {
    Random random(1);
    const auto draw = [&](const Quantity& q) { return q.low + (q.high - q.low) * random.uniform(); };
    for (int p = 0; p < kPoints; ++p) {
      Point& point = points_.emplace_back();
      for (const auto& name : declared) point.others[name] = draw({"", 0.5, 1.5});
      for (const Quantity& q : known.parameters) point.values[q.name] = draw(q);
      for (const Quantity& q : known.within.empty() ? coordinates : known.within)
        point.others[q.name] = point.values[q.name] = draw(q);
    }
  }

  // Each known parameter by its own name or, where that does not do, by any other.
  std::optional<Recognized> run() {
    std::vector<std::string> names;
    for (const Quantity& q : known_.parameters) names.emplace_back(q.name);
    const auto is_declared = [&](const auto& n) {
      return std::find(declared_.begin(), declared_.end(), n) != declared_.end();
    };
    if (std::all_of(names.begin(), names.end(), is_declared))
      if (const auto factor = factor_under(names)) return recognized(names, *factor);
    if (declared_.size() > kMostDeclared) return {};
    names.clear();
    return search(names);
  }

 private:
  struct Point {
    Expression::Values values, others;  // of the known energy, of the other
  };

  std::optional<Recognized> search(std::vector<std::string>& names) {
    if (names.size() == known_.parameters.size()) {
      const auto factor = factor_under(names);
      if (!factor) return {};
      return recognized(names, *factor);
    }
    for (const auto& name : declared_) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      names.push_back(name);
      if (auto found = search(names)) return found;
      names.pop_back();
    }
    return {};
  }

  Recognized recognized(const std::vector<std::string>& names, double factor) const {
    Recognized found{factor, {}};
    for (std::size_t k = 0; k < names.size(); ++k) found.name_of[known_.parameters[k].name] = names[k];
    return found;
  }

  std::optional<double> factor_under(const std::vector<std::string>& names) {
    std::array<double, kPoints> value, other, ratio;
    for (int p = 0; p < kPoints; ++p) {
      Point& point = points_[p];
      Expression::Values given = point.others;
      for (std::size_t k = 0; k < names.size(); ++k)
        given[names[k]] = point.values[known_.parameters[k].name];
      value[p] = known_energy_(point.values);
      other[p] = energy_(given);
      ratio[p] = other[p] / value[p];
      if (!std::isfinite(ratio[p]) || ratio[p] == 0) return {};
    }
    std::nth_element(ratio.begin(), ratio.begin() + kPoints / 2, ratio.end());
    const double factor = ratio[kPoints / 2];
    for (int p = 0; p < kPoints; ++p)
      if (!(std::abs(other[p] / factor - value[p]) <= kTolerance * (std::abs(value[p]) + kNear))) return {};
    return factor;
  }

  const Expression& energy_;
  Expression known_energy_;
  const KnownEnergy& known_;
  const std::vector<std::string>& declared_;
  std::vector<Point> points_;
};

}  // namespace

std::optional<Recognized> recognize(const Expression& energy, const std::vector<std::string>& declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known) {
  return Comparison(energy, declared, coordinates, known).run();
}

}  // namespace taut
