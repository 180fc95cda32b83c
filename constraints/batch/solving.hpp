#pragma once

#include <algorithm>
#include <vector>

#include "constraints/batch/separators.hpp"

namespace taut {

// The stage that a kernel runs for its parts. Whole clusters run all stages in one call; pieces of chains
// stop where they need values from their neighbours.
enum class SolveStage {
  kWhole,
  kStart,  // load, set up, eliminate
  kBack,   // substitute back
  kGoOn,   // apply what was found, set up, eliminate again
  kLast,   // substitute back, apply, end
  kEnd,    // end: nothing to solve
};

// What a part needs after a stage: nothing, one last solve, or a solve and another look at the residuals.
enum class SolveNext { kEnd, kLastSolve, kSolve };

struct SolveCall {
  SolveStage stage = SolveStage::kWhole;
  int solves = 0;  // number of solves so far
};

// The arguments of the kernel of velocities (velocities-inl.hpp).
struct VelocityStep {
  double h;
  const double* x;
  double* v;
};

// A batch with the data that every method with a linear solve keeps for it.
struct SolvedBatch {
  LaneBatch lanes;
  LaneRows lambda;
  LaneRows scratch;             // of pieces, kept from stage to stage
  std::vector<SolveNext> next;  // of pieces: what each group needs after the last stage

  explicit SolvedBatch(const ClusterBatch& batch)
      : lanes(batch),
        lambda(rows_of_bonds(lanes)),
        scratch(lanes.piece() ? lanes.groups : 0, lanes.piece() ? lanes.scratch_rows() : 0),
        next(lanes.piece() ? lanes.groups : 0) {}
};

// All clusters of a method: whole ones and pieces of cut chains.
template <class Batch>
class SolvedBatches {
 public:
  explicit SolvedBatches(const BondClusters& clusters) : whole_(clusters.batches), pieces_(clusters.pieces) {
    std::vector<const LaneBatch*> lanes;
    for (const Batch& batch : pieces_) lanes.push_back(&batch.lanes);
    separators_ = Separators(clusters.chains, lanes);
  }

  // Calls kernel(batch, step, call, group begin, group end, scratch) → SolveStats.
  template <class Kernel, class Step>
  SolveStats run(const Kernel& kernel, const Step& step) {
    SolveStats stats = whole_.run(kernel, step, SolveCall{});
    if (!pieces_.empty()) stats.beside(run_pieces(kernel, step));
    return stats;
  }

  void for_each(const auto& visit) {
    for (Batch& batch : whole_) visit(batch);
    for (Batch& batch : pieces_) visit(batch);
  }
  void serialize(Archive& archive) { archive(whole_, pieces_); }
  void write_lambda(Eigen::VectorXd& lambda) const {
    whole_.write_lambda(lambda);
    pieces_.write_lambda(lambda);
  }

 private:
  template <class Kernel, class Step>
  SolveStats run_pieces(const Kernel& kernel, const Step& step) {
    SolveCall call{SolveStage::kStart, 0};
    const auto run = [&](SolveStage stage) {
      call.stage = stage;
      return pieces_.run(kernel, step, call);
    };
    const auto scratch = [&](int b) -> LaneRows& { return pieces_[b].scratch; };
    separators_.share([&](int b) -> LaneRows& { return pieces_[b].lambda; });

    SolveStats stats = run(SolveStage::kStart);
    while (stats.converged() && next() == SolveNext::kSolve) {
      if (stats = separators_.solve(scratch); !stats.converged()) return stats;
      stats = run(SolveStage::kBack);
      separators_.share(scratch);
      ++call.solves;
      stats = run(SolveStage::kGoOn);
    }
    if (stats.converged() && next() == SolveNext::kLastSolve) {
      if (stats = separators_.solve(scratch); !stats.converged()) return stats;
      stats = run(SolveStage::kLast);
      ++call.solves;
    } else if (stats.converged()) {
      stats = run(SolveStage::kEnd);
    }
    stats.iterations = call.solves;
    return stats;
  }
  // Returns the most that any piece needs.
  SolveNext next() const {
    SolveNext most = SolveNext::kEnd;
    for (const Batch& batch : pieces_)
      for (SolveNext of_group : batch.next) most = std::max(most, of_group);
    return most;
  }

  LaneBatches<Batch> whole_, pieces_;
  Separators separators_;
};

}  // namespace taut
