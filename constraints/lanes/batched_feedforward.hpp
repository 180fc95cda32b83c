#pragma once

#include "constraints/feedforward.hpp"
#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/solving.hpp"

namespace taut {

// A batch and what Feedforward keeps of it: λ of the last three steps.
struct FeedforwardBatch : SolvedBatch {
  LaneRows before, before_that;

  explicit FeedforwardBatch(const ClusterBatch& batch)
      : SolvedBatch(batch), before(rows_of_bonds(lanes)), before_that(before) {}

  void serialize(Archive& archive) { archive(lambda, before, before_that); }
};

template <>
class Batched<Feedforward> : public EmptyGaps {
 public:
  using Reference = Feedforward;
  using Options = Feedforward::Options;
  static constexpr const char* kName = Feedforward::kName;
  static constexpr const char* kSummary = Feedforward::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(batches_, leftover_, known_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  Options options_;
  double h_;
  SolvedBatches<FeedforwardBatch> batches_;
  Leftover<Feedforward> leftover_;
  int known_ = 0;                   // how many λ of the past there are
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
