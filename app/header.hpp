#pragma once

#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace taut {

// What a run is, above its rows; and what of it is told of a scene that does not run, too.
void print_header(const Simulation& simulation);
void print_title(const Scene& scene);
std::string box_line(const Box& box);  // "box 1.86 × 1.86 × 1.86 nm"
std::string start_line(
    const Scene& scene);  // "1000 steps of 2 fs = 2 ps, seed 1, velocities …, Langevin's …"

void print_row(const Record& record);

}  // namespace taut
