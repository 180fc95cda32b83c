#pragma once

#include "constraints/feedforward.hpp"
#include "constraints/lanes/batched.hpp"

namespace taut {

// A batch and what Feedforward keeps of it: λ of the last three steps, newest first.
struct FeedforwardBatch {
  LaneBatch lanes;
  LaneRows lambda, before, before_that;
};

template <>
class Batched<Feedforward> : public EmptyGaps {
 public:
  using Witness = Feedforward;
  using Options = Feedforward::Options;
  static constexpr const char* kName = Feedforward::kName;
  static constexpr const char* kSummary = Feedforward::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s);

  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  Options options_;
  double h_;
  std::vector<FeedforwardBatch> batches_;
  LaneRunner runner_;
  Leftover<Feedforward> leftover_;
  int known_ = 0;                   // how many λ of the past there are
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
