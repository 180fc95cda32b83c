#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "systems/openmm/expression.hpp"

namespace taut {

// A parameter or coordinate of an energy, and the values that it may have.
struct Quantity {
  std::string name;
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

struct Domain {
  std::vector<Quantity> parameters, coordinates;
};
// Another energy of the same quantities, and its branches' ways; of an infinite error where it does not count.
using Reference = std::function<Expression::Rough(const Expression::Values&, Expression::Ways&)>;

// Whether an energy is the same as another at all values of the quantities, to ten digits of what it adds up.
//
// Between two turns of its branches (step, select, min, max, abs, floor, nearest images) a formula is analytic, and
// analytic functions that agree along a piece of a line agree as far as both are analytic. What resembles a known
// energy and is another is hence the same up to a turn: a tail, a cap, a region. So the energies are compared along
// lines through the whole range of each coordinate, 1e-3 to 1e4 nm to both sides, at the numbers that stand in the
// text and at values of the parameters, a little less and a little more; and wherever a branch goes another way at
// two neighbouring points, the turns between them are narrowed down and both sides compared. A branch that went one
// way at every point is not known to agree beyond: then the answer is no.
bool agree_everywhere(const Expression& energy, const Domain& domain, const Reference& reference);

// Returns a value of a quantity, up to `far` to both sides where nothing bounds it; and whether two values are the same
// but for what they are uncertain by.
double drawn(const Quantity& q, Random& random, double far);
bool same(const Expression::Rough& a, const Expression::Rough& b);

}  // namespace taut
