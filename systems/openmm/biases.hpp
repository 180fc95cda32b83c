#pragma once

#include <pugixml.hpp>
#include <vector>

#include "forcefield/bias.hpp"

namespace taut {

// Appends biases to a System's <Forces>: a CustomCentroidBondForce each, and for R_g one within a CustomCVForce. A
// component's nearest image is that of the box as it is now. Throws InputError for a bias that moves, since OpenMM's
// forces do not depend on time.
void write_biases(pugi::xml_node forces, const std::vector<Bias>& biases, const Box& box);

}  // namespace taut
