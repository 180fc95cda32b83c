#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include "constraints/batch/lanes.hpp"
#include "constraints/batch/multiplier_history.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// The method Plain with its clusters side by side in SIMD lanes and on threads. The plain form is the recipe
// to read and the reference of the tests, and it holds the clusters that fit no batch.
template <class Plain>
class Batched;

// The bonds that fit no batch, as a system of their own on the same atoms, and the plain method for them.
// With no such bonds the method only reports its options.
template <class Plain>
class Leftover {
 public:
  // make_method(system) → std::unique_ptr<Plain>
  template <class MakeMethod>
  Leftover(const System& sys, std::vector<int> bonds, const MakeMethod& make_method)
      : bonds_(std::move(bonds)), system_(part_of(sys, bonds_)), method_(make_method(system_)) {}
  Leftover(const Leftover& other) requires(!std::is_same_v<Plain, ConstraintMethod>)
      : bonds_(other.bonds_), system_(other.system_), method_(std::make_unique<Plain>(*other.method_)) {}

  SolveStats project_positions(double h, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_->project_positions(system_, h, s));
  }
  SolveStats add_forces(const Push& push, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_->add_forces(system_, push, s));
  }
  SolveStats project_velocities(double h, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_->project_velocities(system_, h, s));
  }

  // Calls lambda() once, because a method in lanes gathers all multipliers at each call.
  void write_lambda(Eigen::VectorXd& lambda) const {
    const Eigen::VectorXd& of_method = method_->lambda();
    for (std::size_t k = 0; k < bonds_.size(); ++k) lambda[bonds_[k]] = of_method[k];
  }
  // Copies the multipliers of previous steps out of the method and into it; past: m × steps, newest first.
  void read_past(Eigen::MatrixXd& past) {
    const auto kept = method_->past();
    for (std::size_t k = 0; k < bonds_.size(); ++k)
      for (std::size_t n = 0; n < kept.size(); ++n) past(bonds_[k], n) = (*kept[n])[k];
  }
  void write_past(const Eigen::MatrixXd& past, int known) {
    const auto kept = method_->past();
    for (std::size_t k = 0; k < bonds_.size(); ++k)
      for (std::size_t n = 0; n < kept.size(); ++n) (*kept[n])[k] = past(bonds_[k], n);
    method_->steps_known() = known;
  }
  SolveStats again(const Push& push, State& s) {
    return bonds_.empty() ? SolveStats{} : numbered(method_->again(system_, push, s));
  }
  void serialize(Archive& archive) { archive(*method_); }
  const Plain& method() const { return *method_; }

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
  std::unique_ptr<Plain> method_;
};

// The common part of all methods in lanes: the batches and the leftover bonds.
template <class PlainMethod, class Batches>
class BatchedMethod : public ConstraintMethod {
 public:
  using Plain = PlainMethod;
  using Options = typename Plain::Options;

  void serialize(Archive& archive) override { archive(batches_, leftover_); }
  const Eigen::VectorXd& lambda() const final {
    batches_.write_lambda(lambda_);
    leftover_.write_lambda(lambda_);
    return lambda_;
  }
  double promised_error() const override { return leftover_.method().promised_error(); }
  std::string setting() const override { return leftover_.method().setting(); }
  Holds holds() const final { return leftover_.method().holds(); }

 protected:
  BatchedMethod(const System& sys, const Options& options, double h, const BondClusters& clusters)
      : options_(options),
        batches_(clusters),
        leftover_(sys, clusters.rest,
                  [&](const System& part) { return std::make_unique<Plain>(part, options, h); }),
        lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

  Options options_;
  Batches batches_;
  Leftover<Plain> leftover_;

 private:
  mutable Eigen::VectorXd lambda_;  // m
};

// A method in lanes that extrapolates its multipliers from previous steps.
template <class PlainMethod, class Batches>
class ExtrapolatingMethod : public BatchedMethod<PlainMethod, Batches>, public MultiplierHistory {
 public:
  int steps_kept() const final {
    return static_cast<int>(std::tuple_size_v<decltype(std::declval<PlainMethod&>().past())>);
  }
  int steps_known() const final { return known_; }
  void read(Eigen::MatrixXd& past) final {
    this->batches_.for_each([&](auto& batch) {
      for (int n = 0; LaneRows * rows : batch.past()) rows_to_bonds(batch.lanes, *rows, past.col(n++));
    });
    this->leftover_.read_past(past);
  }
  void write(const Eigen::MatrixXd& past, int known) final {
    this->batches_.for_each([&](auto& batch) {
      for (int n = 0; LaneRows * rows : batch.past()) rows_from_bonds(batch.lanes, past.col(n++), *rows);
    });
    this->leftover_.write_past(past, known);
    known_ = known;
  }
  void serialize(Archive& archive) final {
    BatchedMethod<PlainMethod, Batches>::serialize(archive);
    archive(known_);
    archive.demand(0 <= known_ && known_ <= 3);
  }

 protected:
  using BatchedMethod<PlainMethod, Batches>::BatchedMethod;
  int known_ = 0;  // number of previous steps whose λ is known
};

}  // namespace taut
