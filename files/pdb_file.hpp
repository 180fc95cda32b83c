#pragma once

#include <filesystem>

#include "files/frame.hpp"

namespace taut {

// The start for viewers, and the names a trajectory lacks: Å, unwrapped, CRYST1 with a box, CONECT for the
// rigid bonds of up to 99,999 atoms. Numbers too long for their columns start again from 0; positions lose
// decimals. Written aside and renamed. Throws OutsideError.
void write_pdb(const std::filesystem::path& file, const System& sys, const Names& names, const State& s);

}  // namespace taut
