#pragma once

#include "forcefield/terms.hpp"
#include "md/box.hpp"

namespace taut {

// Forces from outside. Each function adds its forces to f and returns its energy [kJ/mol].

// What takes energy to move: the ends of steered atoms' springs, and the factor of pulls that change in time.
struct SteeringForces {
  double force =
      0;  // mean of the springs' along their directions; of the pulls', where there is no spring [kJ/mol/nm]
  double power = 0;  // Σ force × speed of the springs, and what it takes to change the pulls [kJ/mol/ps]
};

double add_gravity(const Vec3& g, const Eigen::VectorXd& mass, const Vectors& x, Vectors& f);
double add_pulls(const std::vector<Pull>& pulls, const Vectors& x, Vectors& f);
double add_changing_pulls(const std::vector<Pull>& pulls, const Course& factor, double t, const Vectors& x,
                          Vectors& f, SteeringForces& forces);
double add_restraints(const std::vector<Restraint>& restraints, const Box& box, const Vectors& x, Vectors& f);

// `push` becomes the force of the atoms on the wall, along its outer normal [kJ/mol/nm]. Throws
// SimulationFailure for an atom on the wall or behind it.
double add_wall(const Wall& wall, const Vectors& x, Vectors& f, double& push);

double add_steering(const std::vector<SteeredAtom>& atoms, double t, const Vectors& x, Vectors& f,
                    SteeringForces& forces);

}  // namespace taut
