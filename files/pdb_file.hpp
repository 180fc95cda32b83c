#pragma once

#include <filesystem>

#include "files/frame.hpp"

namespace taut {

// Writes the start for viewers, with the names that a trajectory lacks: Å, unwrapped, CRYST1 if there is a
// box, CONECT for bonds and springs of up to 99,999 atoms. Numbers too long for their columns start again
// from 0, and large positions lose decimals. The file is written under another name and renamed. Throws
// OutsideError.
void write_pdb(const std::filesystem::path& file, const TrajectorySetup& setup, const State& s);

}  // namespace taut
