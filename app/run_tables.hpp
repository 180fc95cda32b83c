#pragma once

#include <string>

#include "simulation/simulation.hpp"

namespace taut {

// What `taut run` prints: a header, a row for each row of the log, and a summary.
void print_header(const Simulation& simulation);
void print_row(const Record& record);
void print_summary(const Simulation& simulation, const Summary& summary, bool took_steps);

// Where the time went, as GROMACS's cycle accounting has it: nothing where no parts were measured.
void print_timings(const Timings& timings);

// The parts of the header that describe a scene before it runs.
void print_title(const Scene& scene);
// With what is bonded around it:
std::string box_line(const Scene& scene, const Box& box);  // "box 1.86 × 1.86 × 1.86 nm"
std::string start_line(const Scene& scene);  // "1000 steps of 2 fs = 2 ps, seed 1, velocities …"

}  // namespace taut
