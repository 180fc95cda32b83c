#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/region_meter.hpp"

namespace taut {

// What a run does, cut into parts that do not overlap.
enum class StepPart : std::uint8_t {
  kPairs,       // forces between pairs of atoms within the cutoff
  kPairSearch,  // the search for the outer pair list
  kPrune,       // pruning the inner pair list from it
  kCopies,      // positions to clusters, forces of clusters to atoms
  kMeshSpread,  // of PME: charges to the grid, and the transforms of its planes
  kMeshSolve,   // the other transforms, and the influence function
  kMeshGather,  // forces from the grid
  kExclusions,  // what excluded pairs have of the grid's forces
  kBonded,      // bonds, angles, torsions, exceptions
  kFields,      // gravity, pulls, restraints, forces of one's own
  kSites,       // virtual sites
  kBonds,       // the constraint method
  kUpdate,      // kicks and drift
  kThermostat,  // and what takes the momentum out
  kBarostat,    // with the forces of its trials
  kAccount,     // the work of the forces, for the drift
  kLog,         // rows of the log: energies, temperatures, pressure
  kSnapshots,   // the states that a failure is explained from
  kOutput,      // trajectories, checkpoints, and what watches the run
  kRest,        // what is in no other part
};
inline constexpr int kStepParts = static_cast<int>(StepPart::kRest) + 1;
const char* name_of(StepPart part);

// What a part took.
struct PartTime {
  StepPart part;
  long calls = 0;
  double seconds = 0;
  double waiting = 0;  // of all threads together, with nothing to do [s]
};

// Cuts the time of the thread that makes it into parts, while it lives: at any instant one part runs, so the
// parts add up to the whole. A call of a part takes some 25 ns, for two readings of the processor's own clock.
class PartMeter final : public RegionMeter {
 public:
  enum class Parts { kAll, kBonds };  // the bonds alone, where steps are so short that clocks would show
  PartMeter(int threads, Parts parts);
  ~PartMeter() override;

  double seconds() const;                  // since it was made
  double seconds_of(StepPart part) const;  // up to the last change of parts
  // Of the parts that were called and of the rest, up to now. Nothing where the bonds alone are measured.
  std::vector<PartTime> times() const;

  std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument) override;

 private:
  friend class PartScope;
  struct Count {
    long calls = 0;
    std::uint64_t ticks = 0, in_regions = 0, busy = 0;  // busy: of all threads, in regions
  };
  struct alignas(64) Spent {
    std::uint64_t ticks = 0;
  };

  StepPart change(StepPart to);  // returns the part before
  double seconds_per_tick() const;

  int threads_;
  Parts parts_;
  PartMeter* before_;   // which goes on when this one is gone
  bool whole_ = false;  // the part that runs counts whole
  StepPart running_ = StepPart::kRest;
  std::uint64_t start_, since_;
  double started_;  // by the steady clock [s]
  std::array<Count, kStepParts> count_{};
  std::vector<Spent> spent_;  // by t, in the region at hand
};

// Counts the time until it goes out of scope as that of a part, where there is a PartMeter on this thread.
// Barostat, log, snapshots and output count whole, with the forces that they ask for.
class PartScope {
 public:
  explicit PartScope(StepPart part);
  ~PartScope();
  PartScope(const PartScope&) = delete;
  PartScope& operator=(const PartScope&) = delete;

 private:
  PartMeter* meter_;  // null: this scope does not count
  StepPart before_{};
};

// Calls work() as a part of the step.
auto in_part(StepPart part, const auto& work) {
  const PartScope scope(part);
  return work();
}

}  // namespace taut
