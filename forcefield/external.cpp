#include "forcefield/external.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"

namespace taut {

// E = −m g·x
double add_gravity(const Vec3& g, const Eigen::VectorXd& mass, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    energy -= mass[i] * g.dot(x.col(i));
    f.col(i) += mass[i] * g;
  }
  return energy;
}

// E = −F·x
double add_pulls(const std::vector<Pull>& pulls, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [atom, force] : pulls) {
    energy -= force.dot(x.col(atom));
    f.col(atom) += force;
  }
  return energy;
}

// E = −c(t)F·x. What moves c does the work −∫ċ F·x dt.
double add_changing_pulls(const std::vector<Pull>& pulls, const Course& factor, double t, const Vectors& x,
                          Vectors& f, SteeringForces& forces) {
  const double c = factor.at(t), rate = factor.rate(t);
  double energy = 0;
  for (const auto& [atom, force] : pulls) {
    const double along = force.dot(x.col(atom));
    energy -= c * along;
    f.col(atom) += c * force;
    forces.force += c * force.norm() / static_cast<double>(pulls.size());
    forces.power -= rate * along;
  }
  return energy;
}

// d = |P(x − at)|, E = ½k max(d − free, 0)²
double add_restraints(const std::vector<Restraint>& restraints, const Box& box, const Vectors& x,
                      Vectors& f) {
  double energy = 0;
  for (const Restraint& r : restraints) {
    Vec3 off = r.axes.cwiseProduct(x.col(r.atom) - r.at);
    if (r.takes_image) off = box.nearest_image(off);
    if (r.side * off.sum() < 0) continue;
    if (r.free > 0) {
      const double d = off.norm();
      if (d <= r.free) continue;
      off *= 1 - r.free / d;
    }
    energy += 0.5 * r.k * off.squaredNorm();
    f.col(r.atom) -= r.k * off;
  }
  return energy;
}

// With s = σ/z: E = ε(2/15 s⁹ − s³) − E(cutoff), −dE/dz = 3ε/z (2/5 s⁹ − s³).
double add_wall(const Wall& wall, const Vectors& x, Vectors& f, double& push) {
  const auto energy_at = [&](double z) {
    const double s3 = std::pow(wall.sigma / z, 3);
    return wall.epsilon * (2.0 / 15 * s3 * s3 * s3 - s3);
  };
  const double shift = wall.cutoff ? energy_at(*wall.cutoff) : 0;
  double energy = 0;
  push = 0;
  for (const int a : wall.atoms) {
    const double z = wall.faces * (x(wall.axis, a) - wall.at);
    if (z <= 0)
      throw SimulationFailure(
          fmt::format("atom {} is behind the wall at {} = {:g} nm, at {:g} nm; take a shorter step, or start "
                      "with all atoms in front of it",
                      a, "xyz"[wall.axis], wall.at, x(wall.axis, a)));
    if (wall.cutoff && !(z < *wall.cutoff)) continue;
    const double s3 = std::pow(wall.sigma / z, 3);
    const double force = 3 * wall.epsilon / z * s3 * (0.4 * s3 * s3 - 1);
    energy += wall.epsilon * s3 * (2.0 / 15 * s3 * s3 - 1) - shift;
    push += force;
    f(wall.axis, a) += wall.faces * force;
  }
  return energy;
}

// E = ½k d², d = speed·(t − since) − along·(x − from)
double add_steering(const std::vector<SteeredAtom>& atoms, double t, const Vectors& x, Vectors& f,
                    SteeringForces& forces) {
  double energy = 0;
  forces.force = 0;
  for (const auto& [atom, along, speed, k, from, since] : atoms) {
    const double stretch = speed * (t - since) - along.dot(x.col(atom) - from);
    energy += 0.5 * k * stretch * stretch;
    f.col(atom) += k * stretch * along;
    forces.force += k * stretch / static_cast<double>(atoms.size());
    forces.power += k * stretch * speed;
  }
  return energy;
}

}  // namespace taut
