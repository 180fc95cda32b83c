#include "studies/swept_errors.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/words.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {

Eigen::VectorXd SweptErrors::swept(const Eigen::VectorXd& sigma) const {
  Vectors moved = Vectors::Zero(3, sys_.atoms());
  const auto left = [&](int k) {
    return sigma[k] + sys_.along(sys_.bonds[k], x_).dot(sys_.difference(sys_.bonds[k], moved));
  };
  for (int sweep = 0; sweep < sweeps_; ++sweep)
    for (int k = 0; k < sys_.bond_count(); ++k) {
      const Vec3 r = sys_.along(sys_.bonds[k], x_);
      const double g = -left(k) / (sys_.reduced_inv_mass(sys_.bonds[k]) * r.squaredNorm());
      add_constraint_acceleration(sys_, k, g * r, moved);
    }
  Eigen::VectorXd after(sigma.size());
  for (int k = 0; k < sys_.bond_count(); ++k) after[k] = left(k);
  return after;
}

std::vector<Eigen::VectorXd> SweptErrors::course(Eigen::VectorXd stretch, int steps) const {
  std::vector<Eigen::VectorXd> course = {std::move(stretch)};
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(course[0].size());
  for (int n = 0; n < steps; ++n) {
    const Eigen::VectorXd next = swept(course[n] + rate);
    rate = swept(next - course[n]);
    course.push_back(next);
  }
  return course;
}

// By its powers, from an error that has a part of all; pairs that turn average out over half of them.
double SweptErrors::slowest() const {
  constexpr int kPowers = 200;
  Eigen::VectorXd error(sys_.bond_count());
  for (int k = 0; k < sys_.bond_count(); ++k) error[k] = std::pow(sys_.bonds[k].length, 2) * (1 + k % 7);
  double log_of_half = 0;
  for (int n = 0; n < kPowers; ++n) {
    const double before = error.norm();
    error = swept(error);
    const double after = error.norm();
    if (!(after > 1e-12 * before)) return 0;
    if (n >= kPowers / 2) log_of_half += std::log(after / before);
    error /= after;
  }
  return std::exp(log_of_half / (kPowers - kPowers / 2));
}

std::vector<SweptShape> cluster_shapes(const System& sys) {
  std::map<std::vector<double>, std::size_t> known;
  std::vector<SweptShape> shapes;
  std::vector<int> counts;
  for (const auto& [first, bonds] : bonds_of_clusters(sys)) {
    std::vector<double> kind;
    for (const int k : bonds) {
      sys.for_each_bearer(sys.bonds[k], [&](int a, double c) { kind.insert(kind.end(), {sys.mass[a], c}); });
      kind.push_back(sys.bonds[k].length);
    }
    const std::size_t shape = known.try_emplace(kind, known.size()).first->second;
    shapes.resize(known.size());
    counts.resize(known.size(), 0);
    const int count = ++counts[shape];
    shapes[shape].name =
        fmt::format("{} of {}", counted(count, "cluster"), counted(std::ssize(bonds), "bond"));
    shapes[shape].bonds.insert(shapes[shape].bonds.end(), bonds.begin(), bonds.end());
  }
  return shapes;
}

}  // namespace taut
