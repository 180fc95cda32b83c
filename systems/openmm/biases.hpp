#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "forcefield/bias.hpp"

namespace taut {

// Appends biases to a System's <Forces>: a CustomCentroidBondForce each, and for R_g one within a CustomCVForce. A
// component's nearest image is that of the box as it is now. Throws InputError for a bias that moves, since OpenMM's
// forces do not depend on time.
void write_biases(pugi::xml_node forces, const std::vector<Bias>& biases, const Box& box);

// A wall at ±this is none: what it is written as where there is none, which no value reaches.
constexpr double kFarWall = 1e6;
// Energies that are read as they are written: of a component, and of each atom of a group whose R_g² they add to.
std::string component_energy(bool periodic);
constexpr const char* kSquaresEnergy = "w*distance(g1,g2)^2";

}  // namespace taut
