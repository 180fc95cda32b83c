#pragma once

#include "constraints/lanes/batched.hpp"
#include "constraints/lincs.hpp"

namespace taut {

// A batch and what Lincs keeps of it.
struct LincsBatch {
  LaneBatch lanes;
  std::vector<double> length, scale;  // d and S of each bond
  std::vector<char> inside;           // of each entry of C: whether its bonds are sides of a triangle
  bool triangles = false;             // there are such
  LaneRows lambda;

  explicit LincsBatch(const ClusterBatch& batch);

  void serialize(Archive& archive) { archive(lambda); }
};

template <>
class Batched<Lincs> : public EmptyGaps {
 public:
  using Reference = Lincs;
  using Options = Lincs::Options;
  static constexpr const char* kName = Lincs::kName;
  static constexpr const char* kSummary = Lincs::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s);
  SolveStats project_velocities(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(batches_, leftover_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return leftover_.method().promised_error(); }
  std::string setting() const { return leftover_.method().setting(); }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);

  Options options_;
  std::vector<LincsBatch> batches_;
  LaneRunner runner_;
  Leftover<Lincs> leftover_;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
