#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "files/folder.hpp"
#include "files/output.hpp"
#include "simulation/checkpoint.hpp"
#include "simulation/log_columns.hpp"
#include "simulation/simulation.hpp"
#include "simulation/trajectories.hpp"

namespace taut {

// The folder of a run:
//     log.csv, trajectories                grow while it goes on; start.pdb has the names of the atoms
//     checkpoint.cbor                      where it can go on from; always whole
//     summary.json, final.start.toml       written when it is done
//     failure.json, last_good.start.toml   or when it failed
// Throws OutsideError where the disk refuses.
class RunFolder {
 public:
  // Without marks the run sets out anew, and what an earlier one left there is set aside
  // (files/folder.hpp). With them it goes on from a checkpoint; an output that has no mark sets out anew.
  RunFolder(FolderLock folder, SceneSource source, const Simulation& simulation, const Marks& marks = {});

  const std::filesystem::path& path() const { return folder_.path(); }
  // Says where the files of an earlier run were moved to; empty if there were none.
  const std::string& note() const { return note_; }
  void set_source(SceneSource source) {
    checkpoint_.source = std::move(source);
  }                                    // other settings from here on
  void begin(Simulation& simulation);  // a checkpoint; at the start the first frame before it
  void add_row(const Record& record);
  void add_frame(const Simulation& simulation);                 // to the trajectories, if one is due
  void keep(Simulation& simulation);                            // a checkpoint
  std::optional<long> kept_step() const { return kept_step_; }  // of the last good checkpoint
  // Outputs that have grown to more than twice what that checkpoint knows of, which a run that goes on cuts back.
  std::vector<std::string> outgrown(const Simulation& simulation) const;
  void write_end(const Simulation& simulation, const Summary& summary);
  void write_failure(const Simulation& simulation, const Diagnosis& diagnosis);

 private:
  FolderLock folder_;
  std::string note_;
  Checkpoint checkpoint_;  // what it is made from; the rest only while one is written
  GrowingFile log_;
  std::vector<LogColumn> columns_;
  Trajectories trajectories_;
  std::optional<long> kept_step_;
  Marks kept_marks_;  // of the last good checkpoint
};

// An estimate as all JSON of taut has it: its value, and its standard error, null where there are too few samples.
nlohmann::ordered_json json_of(const Estimate& e);

// What summary.json holds.
nlohmann::ordered_json summary_json(const Simulation& simulation, const Summary& summary);

// What there is of a run in a folder: names of files.
std::vector<std::string> run_files(const std::filesystem::path& folder);

// The outputs of a run beside what its checkpoint knows of them: names of files.
struct OutputsFound {
  std::vector<std::string> missing;  // not there, or shorter than they were
  std::vector<std::string> longer;   // more than twice as long
};
OutputsFound find_outputs(const std::filesystem::path& folder, const Simulation& simulation,
                          const Marks& marks);

}  // namespace taut
