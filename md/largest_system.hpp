#pragma once

namespace taut {

// Indices are of 32 bits, those into 3 × atoms and into a thread's pair list, too. A liquid takes about 2.5 kB an atom, and
// up to 0.1 kB more for each thread, which adds to forces of its own.
inline constexpr double kMostAtoms = 1e7;

void refuse_more_atoms(double atoms);  // throws InputError for more than kMostAtoms

}  // namespace taut
