#pragma once

#include "constraints/batch/batched.hpp"
#include "constraints/methods/lincs.hpp"

namespace taut {

// A batch with the data that Lincs keeps for it.
struct LincsBatch {
  LaneBatch lanes;
  std::vector<double> length, scale;  // d and S of each bond
  std::vector<char> inside;           // for each entry of C: whether its bonds are sides of a triangle
  bool triangles = false;             // whether there is any such entry
  LaneRows lambda;

  explicit LincsBatch(const ClusterBatch& batch);

  void serialize(Archive& archive) { archive(lambda); }
};

template <>
class Batched<Lincs> final : public BatchedMethod<Lincs, LaneBatches<LincsBatch>> {
 public:
  Batched(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;
};

}  // namespace taut
