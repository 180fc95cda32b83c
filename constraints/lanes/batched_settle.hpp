#pragma once

#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/solving.hpp"
#include "constraints/settle.hpp"

namespace taut {

// Waters of one shape: atoms apex, left, right; bonds apex–left, apex–right, left–right.
struct SettleBatch : SolvedBatch {
  double ra, rb, rc;  // settle.hpp

  SettleBatch(const ClusterBatch& batch, const Settle::Water& water)
      : SolvedBatch(batch), ra(water.ra), rb(water.rb), rc(water.rc) {}

  void serialize(Archive& archive) { archive(lambda); }
};

template <>
class Batched<Settle> : public EmptyGaps {
 public:
  using Reference = Settle;
  using Options = Settle::Options;
  static constexpr const char* kName = Settle::kName;
  static constexpr const char* kSummary = Settle::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(batches_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return 1e-12; }
  std::string setting() const;

 private:
  std::vector<SettleBatch> batches_;
  LaneRunner runner_;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
