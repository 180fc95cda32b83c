#pragma once

#include <filesystem>

#include "files/frame.hpp"

namespace taut {

// The start for viewers, and the names a trajectory lacks: Å, unwrapped, CRYST1 with a box, CONECT for the
// bonds of up to 99,999 atoms, springs too. Numbers too long for their columns start again from 0; positions
// lose decimals. Written aside and renamed. Throws OutsideError.
void write_pdb(const std::filesystem::path& file, const TrajectorySetup& setup, const State& s);

}  // namespace taut
