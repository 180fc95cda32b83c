#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "files/dcd_file.hpp"
#include "files/h5md_file.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// The trajectories a scene asks for ([run] trajectory, trajectory_every), in a run's folder:
// trajectory.dcd, trajectory.h5md, and start.pdb with the names of the atoms. None where it asks for none.
class Trajectories {
 public:
  // A file without a mark is new, and sets out from the simulation's step; else the one there is is cut back.
  // Throws OutsideError.
  Trajectories(const std::filesystem::path& folder, const Simulation& simulation,
               const std::map<std::string, std::uint64_t>& marks);

  // How far the files asked for are written, by their names, in their marks' units; 0 for what is not there
  // or cannot be read.
  static std::map<std::string, std::uint64_t> extents(const std::filesystem::path& folder,
                                                      const Simulation& simulation);

  bool due(long step) const { return every_ > 0 && step % every_ == 0; }
  void add(const Simulation& simulation, long step);       // the start's frame only where it is not there
  void mark(std::map<std::string, std::uint64_t>& marks);  // of each file, by its name

 private:
  long every_;
  bool dcd_has_start_ = false, h5md_has_start_ = false;  // a run killed before its first step has it
  std::unique_ptr<DcdFile> dcd_;
  std::unique_ptr<H5mdFile> h5md_;
};

}  // namespace taut
