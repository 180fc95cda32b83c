#pragma once

#include "constraints/lanes/batched.hpp"
#include "constraints/rattle.hpp"
#include "constraints/shake.hpp"

namespace taut {

// A batch, its bonds in the system's order, and the multipliers kept of it.
struct SweepBatch {
  LaneBatch lanes;
  LaneRows lambda;

  void serialize(Archive& archive) { archive(lambda); }
};

// SHAKE's and RATTLE's sweeps, a cluster a lane: lanes that hold wait for those of their group that do not
// yet.
class LaneSweeps {
 public:
  LaneSweeps(const System& sys, const BondClusters& clusters, SweepLimits limits);

  // As PositionSweeps and VelocitySweeps; the kept multipliers λ set out as guess·λ and are kept as keep·g.
  SolveStats positions(double h, double guess, double keep, State& s);
  SolveStats velocities(double h, double guess, double keep, State& s);

  void serialize(Archive& archive) { archive(batches_); }
  void write_lambda(Eigen::VectorXd& lambda) const;

 private:
  SweepLimits limits_;
  std::vector<SweepBatch> batches_;
  LaneRunner runner_;
};

template <>
class Batched<Shake> : public EmptyGaps {
 public:
  using Reference = Shake;
  using Options = Shake::Options;
  static constexpr const char* kName = Shake::kName;
  static constexpr const char* kSummary = Shake::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(sweeps_, leftover_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  Leftover<Shake> leftover_;
  LaneSweeps sweeps_;
  mutable Eigen::VectorXd lambda_;  // m
};

template <>
class Batched<Rattle> : public EmptyGaps {
 public:
  using Reference = Rattle;
  using Options = Rattle::Options;
  static constexpr const char* kName = Rattle::kName;
  static constexpr const char* kSummary = Rattle::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(sweeps_, leftover_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  bool warm_start_;
  Leftover<Rattle> leftover_;
  LaneSweeps sweeps_;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
