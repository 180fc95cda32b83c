#pragma once

#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace taut {

// The header that `taut run` prints above its rows, and its parts, which `taut info` prints, too.
void print_header(const Simulation& simulation);
void print_title(const Scene& scene);
std::string box_line(const Box& box);  // "box 1.86 × 1.86 × 1.86 nm"
std::string start_line(
    const Scene& scene);  // "1000 steps of 2 fs = 2 ps, seed 1, velocities …, Langevin's …"

void print_row(const Record& record);

}  // namespace taut
