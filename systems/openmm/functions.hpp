#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "forcefield/spline.hpp"
#include "systems/openmm/expression.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// The tabulated functions of a force: discrete ones, which round their arguments, and continuous ones of one
// argument, natural cubic splines, which are zero outside their range. Those are kept in `splines`, too.
using Splines = std::map<std::string, std::shared_ptr<const Spline>>;
Expression::Tables read_functions(const Element& force, Splines& splines);

// Returns the multiple of one of the splines that an energy of one coordinate is within their ranges, to 1e-9 of its
// largest value; none if it is no multiple of any.
std::shared_ptr<const Spline> recognize_spline(const Splines& splines,
                                               const std::function<double(double)>& energy);

// Returns a spline's value, 0 outside its range; undecided at its ends.
Expression::Rough rough_value(const Spline& spline, double at);

}  // namespace taut
