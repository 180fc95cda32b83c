#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "systems/openmm/comparison.hpp"

namespace taut {

// An energy function that taut computes. A custom force is recognized where its energy is a constant multiple
// of this function, however its formula is written and whatever its parameters are called.
struct KnownEnergy {
  std::string text;
  std::vector<Quantity> parameters;
  std::string where = "1";  // they need only agree where this is above 0
};

// The given energy is `factor` times the known one, with parameters renamed.
struct Recognized {
  double factor;
  std::map<std::string, std::string> name_of;  // from a known parameter to the given energy's
};

// `declared` lists the parameters that may stand for the known ones, beside the energy's named numbers.
std::optional<Recognized> recognize(const Expression& energy, std::vector<std::string> declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known);

}  // namespace taut
