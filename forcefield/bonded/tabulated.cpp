#include "forcefield/bonded/tabulated.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"

namespace taut {
namespace {

// θ at the middle atom, from the arms a and c and p = a × c: θ = atan2(|p|, a·c).
struct Arms {
  Vec3 a, c, normal;
  double sine, theta;

  Arms(const TabulatedAngle& t, const Vectors& x)
      : a(x.col(t.i) - x.col(t.j)),
        c(x.col(t.k) - x.col(t.j)),
        normal(a.cross(c)),
        sine(normal.norm()),
        theta(std::atan2(sine, a.dot(c))) {}
};

double length(const TabulatedBond& t, const Vectors& x) {
  return (x.col(t.j) - x.col(t.i)).norm();
}

double in_degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

std::string why_outside(const TabulatedBond& t, double r) {
  return fmt::format("tabulated bond {}-{} is {:.6g} nm long, its table {} goes from {:g} to {:g} nm", t.i,
                     t.j, r, t.energy->name(), t.energy->first(), t.energy->last());
}
std::string why_outside(const TabulatedAngle& t, double theta) {
  return fmt::format("tabulated angle {}-{}-{} is {:.6g} degrees, its table {} goes from {:g} to {:g}", t.i,
                     t.j, t.k, in_degrees(theta), t.energy->name(), in_degrees(t.energy->first()),
                     in_degrees(t.energy->last()));
}

Spline::Value energy_at(const auto& term, double at) {
  if (term.energy->covers(at)) return term.energy->at(at);
  throw SimulationFailure(why_outside(term, at) + "; take a shorter step, or a table that goes further");
}

}  // namespace

// F_i = dE/dr (x_j − x_i)/r
double add_term_forces(std::span<const TabulatedBond> bonds, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const TabulatedBond& bond : bonds) {
    const Vec3 d = x.col(bond.j) - x.col(bond.i);
    const double r = d.norm();
    const auto [value, slope] = energy_at(bond, r);
    energy += value;
    const Vec3 pull = d * (r > 0 ? slope / r : 0.0);
    f.col(bond.i) += pull;
    f.col(bond.j) -= pull;
  }
  return energy;
}

// F_i = −dE/dθ a × p / (a²|p|),  F_k = dE/dθ c × p / (c²|p|)
double add_term_forces(std::span<const TabulatedAngle> angles, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const TabulatedAngle& angle : angles) {
    const Arms at(angle, x);
    const auto [value, slope] = energy_at(angle, at.theta);
    energy += value;
    if (at.sine == 0) continue;
    const Vec3 on_i = -slope / (at.a.squaredNorm() * at.sine) * at.a.cross(at.normal);
    const Vec3 on_k = slope / (at.c.squaredNorm() * at.sine) * at.c.cross(at.normal);
    f.col(angle.i) += on_i;
    f.col(angle.k) += on_k;
    f.col(angle.j) -= on_i + on_k;
  }
  return energy;
}

void check_tables_cover(const System& sys, const Terms& terms, const Vectors& start) {
  const auto check = [&](const auto& term,
                         double at) {  // those through the box when they are first evaluated
    if (sys.reach_of(term.i) == Reach::kWhole && !term.energy->covers(at))
      throw InputError(why_outside(term, at) + ": move the atoms, or give a table that goes further");
  };
  for (const TabulatedBond& bond : terms.tabulated_bonds) check(bond, length(bond, start));
  for (const TabulatedAngle& angle : terms.tabulated_angles) check(angle, Arms(angle, start).theta);
}

}  // namespace taut
