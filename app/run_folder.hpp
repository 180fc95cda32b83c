#pragma once

#include <filesystem>

#include "md/folder_lock.hpp"
#include "md/output.hpp"
#include "systems/checkpoint.hpp"
#include "systems/simulation.hpp"
#include "systems/trajectories.hpp"

namespace taut {

// The folder of a run:
//     log.csv, trajectories                grow while it goes on
//     checkpoint.cbor                      where it can go on from; always whole
//     summary.json, final.start.toml       written when it is done
//     failure.json, last_good.start.toml   or when it failed
// Throws OutsideError where the disk refuses.
class RunFolder {
 public:
  // Without marks the run sets out anew, and what an earlier one left there goes.
  RunFolder(FolderLock folder, SceneSource source, const Simulation& simulation, const Marks& marks = {});

  const std::filesystem::path& path() const { return folder_.path(); }
  void add_row(const Record& record);
  void add_frame(const Simulation& simulation);  // to the trajectories, if one is due
  void keep(Simulation& simulation);             // a checkpoint
  void write_end(const Simulation& simulation, const Summary& summary);
  void write_failure(const Simulation& simulation, const Diagnosis& diagnosis);

 private:
  FolderLock folder_;
  SceneSource source_;
  GrowingFile log_;
  Trajectories trajectories_;
};

}  // namespace taut
