#pragma once

#include <vector>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// Forces from outside. Each adds its forces to f and returns its energy [kJ/mol].

double add_gravity(const Vec3& g, const Eigen::VectorXd& mass, const Vectors& x, Vectors& f);  // −m g·x
double add_pulls(const std::vector<Pull>& pulls, const Vectors& x, Vectors& f);                // −F·x
double add_restraints(const std::vector<Restraint>& restraints, const Box& box, const Vectors& x, Vectors& f);

}  // namespace taut
