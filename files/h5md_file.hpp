#pragma once

#include <memory>

#include "files/frame.hpp"
#include "files/output.hpp"

namespace taut {

bool built_with_hdf5();  // without it every H5mdFile throws InputError

// H5MD 1.1 with its units module (de Buyl, Colberg and Höfling 2014, doi:10.1016/j.cpc.2014.01.018;
// nongnu.org/h5md), in double precision and taut's own units:
//     /particles/all    position, velocity, force, box/edges (3 × 3, with a box) in time; mass, species
//     /observables/tension      of each rigid bond, in time: an addition of ours
//     /connectivity/bonds       the atoms of each rigid bond, and behind them of each spring
//     /parameters/topology      names: kind and residue of each atom; atom, residue, element of each kind
// Positions are unwrapped. On disk the file is at any instant what it was at a commit (JournaledFile):
// readable by others while it is written, and after a kill. It commits at a mark, on closing, and ten
// seconds after it did so last. An output's mark is in frames.
class H5mdFile : public Output {
 public:
  // mark 0: a new file; else the one there is, cut back to so many frames. Throws OutsideError.
  H5mdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark);
  ~H5mdFile() override;

  // How many a file has; 0 where it is not there or cannot be read. Changes nothing on disk.
  static std::uint64_t frames(const std::filesystem::path& path, const TrajectorySetup& setup);

  void add(const Frame& frame);
  std::uint64_t mark() override;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace taut
