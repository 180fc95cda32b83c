#pragma once

#include <memory>

#include "files/frame.hpp"
#include "files/output.hpp"

namespace taut {

bool built_with_hdf5();  // if false, every H5mdFile throws InputError

// H5MD 1.1 with its units module (de Buyl, Colberg and Höfling 2014, doi:10.1016/j.cpc.2014.01.018;
// nongnu.org/h5md), in double precision and taut's units:
//     /particles/all    position, velocity, force, box/edges (3 × 3, with a box) in time; mass, species
//     /observables/tension      of each rigid bond, in time (an extension)
//     /connectivity/bonds       the atoms of each rigid bond, followed by those of each spring
//     /parameters/topology      names: kind and residue of each atom; atom, residue, element of each kind
// Positions are unwrapped. At any instant the file on disk is as of the last commit (JournaledFile), so that
// others can read it during the run and after a kill. It commits at a mark, on closing, and every ten
// seconds. The mark of this output is in frames.
class H5mdFile : public Output {
 public:
  // mark 0 makes a new file; otherwise the existing one is truncated to so many frames. Throws OutsideError.
  H5mdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark);
  ~H5mdFile() override;

  // Returns the number of frames in a file, 0 if it does not exist or cannot be read. Changes nothing on
  // disk.
  static std::uint64_t frames(const std::filesystem::path& path, const TrajectorySetup& setup);

  void add(const Frame& frame);
  std::uint64_t mark() override;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace taut
