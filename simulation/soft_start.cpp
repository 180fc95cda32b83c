#include "simulation/soft_start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/random.hpp"
#include "forcefield/force_field.hpp"

namespace taut {
namespace {

constexpr double kAmplitude = 100;   // A [kJ/mol]
constexpr double kLeftForce = 0.3;   // of the largest one, πA/r_c, where the descent ends
constexpr double kSamePlace = 1e-9;  // [nm]
constexpr double kNear = 0.1;        // of r_c: the slope of the cosine vanishes there, and would push no more

// A little more than the distance from which on a table's energies stay below A, as pushes end before they have no
// force.
double reach_of(const Spline& table) {
  std::size_t k = table.values().size();
  while (k > 0 && table.values()[k - 1] < kAmplitude) --k;
  return 1.2 * (table.first() + static_cast<double>(k) * table.spacing());
}

// 2^(1/6)σ of each atom, or what its tables keep free; 0 where it has no pair forces.
Eigen::VectorXd diameters(const Terms& terms, int atoms) {
  const double least = std::pow(2.0, 1.0 / 6);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(atoms);
  if (terms.wca) {
    all.setConstant(least * terms.wca->sigma);
    for (const int a : terms.wca->without) all[a] = 0;
    return all;
  }
  if (const auto& pairs = terms.nonbonded)
    for (int a = 0; a < atoms; ++a)
      if (pairs->epsilon[a] > 0) all[a] = least * pairs->sigma[a];
  if (const auto& tables = terms.tabulated_pairs)
    for (const auto& [one, two, energy] : tables->potentials)
      for (int a = 0; a < atoms; ++a)
        if (tables->kind[a] == one || tables->kind[a] == two) all[a] = std::max(all[a], reach_of(*energy));
  return all;
}

std::set<std::pair<int, int>> left_out(const Terms& terms) {
  std::set<std::pair<int, int>> pairs;
  if (terms.nonbonded)
    for (const PairException& e : terms.nonbonded->exceptions) pairs.insert(std::minmax(e.i, e.j));
  if (terms.wca)
    for (const auto& [i, j] : terms.wca->exclusions) pairs.insert(std::minmax(i, j));
  if (terms.tabulated_pairs)
    for (const auto& [i, j] : terms.tabulated_pairs->exclusions) pairs.insert(std::minmax(i, j));
  return pairs;
}

class SoftPush final : public OwnField {
 public:
  SoftPush(const Terms& terms, int atoms, const Box& box)
      : diameter_(diameters(terms, atoms)), left_out_(left_out(terms)), box_(box) {}

  std::string name() const override { return "soft push"; }

  double add(const Vectors& x, Vectors& f) override {
    sort_by_slabs(x);
    double energy = 0;
    for (std::size_t k = 0; k < order_.size(); ++k)
      for_each_behind(k, [&](int j) { energy += add_pair(order_[k].atom, j, x, f); });
    return energy;
  }

 private:
  struct Placed {
    double height;  // along z, in the box [nm]
    int atom;
  };

  // By height, so that neighbours within a diameter are near in the list.
  void sort_by_slabs(const Vectors& x) {
    order_.clear();
    for (Eigen::Index a = 0; a < x.cols(); ++a) {
      if (diameter_[a] == 0) continue;
      double z = x(2, a);
      if (box_.periodic()) z -= box_.edge.z() * std::floor(z / box_.edge.z());
      order_.push_back({z, static_cast<int>(a)});
    }
    std::ranges::sort(order_, {}, &Placed::height);
  }

  // Each pair once, across the box too where there is one that is two diameters high.
  void for_each_behind(std::size_t k, const auto& act) const {
    const double reach = diameter_.maxCoeff(), edge = box_.periodic() ? box_.edge.z() : 0;
    const std::size_t n = order_.size();
    for (std::size_t step = 1; step < n; ++step) {
      const bool across = k + step >= n;
      if (across && !box_.periodic()) return;
      const Placed& other = order_[(k + step) % n];
      if (other.height + (across ? edge : 0) - order_[k].height >= reach) return;
      act(other.atom);
    }
  }

  double add_pair(int i, int j, const Vectors& x, Vectors& f) const {
    const double reach = (diameter_[i] + diameter_[j]) / 2;
    Vec3 d = x.col(j) - x.col(i);
    if (box_.periodic()) d = box_.nearest_image(d);
    double r = d.norm();
    if (r >= reach || left_out_.contains(std::minmax(i, j))) return 0;
    const double energy = kAmplitude * (1 + std::cos(std::numbers::pi * r / reach));
    if (r < kSamePlace) {
      Random random(static_cast<std::uint64_t>(std::min(i, j)));
      d = (i < j ? 1 : -1) * kSamePlace * random.unit_vector();
      r = kSamePlace;
    }
    const double phase =
        std::numbers::pi * (r < kNear * reach ? 0.5 : r / reach);  // where near, the largest force
    const Vec3 push = kAmplitude * std::numbers::pi / reach * std::sin(phase) / r * d;
    f.col(i) -= push;
    f.col(j) += push;
    return energy;
  }

  Eigen::VectorXd diameter_;
  std::set<std::pair<int, int>> left_out_;
  Box box_;
  std::vector<Placed> order_;
};

}  // namespace

int push_apart(const Scene& scene, State& s, const OnMove& on_move) {
  const double widest = diameters(scene.terms, scene.system.atoms()).maxCoeff();
  if (widest == 0) return 0;
  Terms soft = scene.terms;
  soft.own.push_back(std::make_shared<SoftPush>(scene.terms, scene.system.atoms(), s.box));
  soft.nonbonded.reset();
  soft.wca.reset();
  soft.tabulated_pairs.reset();
  ForceField forces(scene.system, s.box, soft);
  const MinimiseGoal goal{.force = kLeftForce * std::numbers::pi * kAmplitude / widest};
  return minimise(scene.system, forces, goal, s, on_move).moves;
}

}  // namespace taut
