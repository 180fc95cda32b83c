#pragma once

#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/solving.hpp"
#include "constraints/newton.hpp"

namespace taut {

// A batch and what Newton keeps of it.
struct NewtonBatch : SolvedBatch {
  LaneRows factors;  // 1/d and L at the last velocities' positions, part by part; pieces have them in scratch

  explicit NewtonBatch(const ClusterBatch& batch)
      : SolvedBatch(batch),
        factors(lanes.groups, lanes.piece() ? 0 : lanes.bond_count() + lanes.plan.entries()) {}

  void serialize(Archive& archive) { archive(lambda, factors, scratch); }
};

template <>
class Batched<Newton> : public EmptyGaps {
 public:
  using Reference = Newton;
  using Options = Newton::Options;
  static constexpr const char* kName = Newton::kName;
  static constexpr const char* kSummary = Newton::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(batches_, leftover_, factored_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  Options options_;
  SolvedBatches<NewtonBatch> batches_;
  Leftover<Newton> leftover_;
  bool factored_ = false;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
