#pragma once

#include <vector>

#include "constraints/gaps.hpp"
#include "constraints/lanes/lanes.hpp"

namespace taut {

// The same method as Plain, its clusters side by side in SIMD lanes and on threads. Plain stays as the recipe
// to read, as the witness of the tests, and for clusters that fit no batch. Each Batched<Plain> has
//     kName, kSummary, Options, lambda(), serialize(), promised_error(), setting() as Plain (methods.hpp),
//     and `using Reference = Plain`.
template <class Plain>
class Batched;

// The bonds that are left to the plain method: as a system of their own on the same atoms. It may have none;
// the method then answers for the options alone.
template <class Plain>
class Leftover {
 public:
  Leftover(const System& sys, std::vector<int> bonds, const typename Plain::Options& options, double h)
      : bonds_(std::move(bonds)), system_(part_of(sys, bonds_)), method_(system_, options, h) {}

  SolveStats project_positions(double h, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_.project_positions(system_, h, s));
  }
  SolveStats add_forces(double h, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_.add_forces(system_, h, s));
  }
  SolveStats project_velocities(double h, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_.project_velocities(system_, h, s));
  }

  void write_lambda(Eigen::VectorXd& lambda) const {
    for (std::size_t k = 0; k < bonds_.size(); ++k) lambda[bonds_[k]] = method_.lambda()[k];
  }
  void serialize(Archive& archive) { archive(method_); }
  const Plain& method() const { return method_; }

 private:
  static System part_of(const System& sys, const std::vector<int>& bonds) {
    if (bonds.empty()) return {};
    System part = sys;
    part.bonds.clear();
    for (int k : bonds) part.bonds.push_back(sys.bonds[k]);
    return part;
  }

  SolveStats numbered(SolveStats stats) const {
    if (stats.worst_bond >= 0) stats.worst_bond = bonds_[stats.worst_bond];
    return stats;
  }

  std::vector<int> bonds_;
  System system_;
  Plain method_;
};

}  // namespace taut
