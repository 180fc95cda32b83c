#pragma once

#include <cmath>

#include "base/random.hpp"
#include "md/force_law.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut::tests {

struct NoForce : ForceLaw {
  void evaluate(const System&, State& s) override { s.f.setZero(); }
};

struct UniformForce : ForceLaw {
  explicit UniformForce(const Vec3& its_g) : g(its_g) {}
  Vec3 g;
  void evaluate(const System& sys, State& s) override {
    for (int i = 0; i < sys.atoms(); ++i) s.f.col(i) = sys.mass[i] * g;
  }
};

struct Start {
  System system;
  State state;
};

// A freely jointed chain of unit bonds, with random directions and velocities of variance kT/m.
inline Start free_chain(int beads, std::uint64_t seed, double speed = 1, double mass = 1) {
  Random random(seed);
  Start start;
  State& s = start.state;
  s.x.resize(3, beads);
  s.v.resize(3, beads);
  s.f = Vectors::Zero(3, beads);
  std::vector<RigidBond> bonds;
  Vec3 at = Vec3::Zero(), direction = random.unit_vector();
  for (int i = 0; i < beads; ++i) {
    s.x.col(i) = at;
    s.v.col(i) = speed * random.normal_vector();
    Vec3 next = random.unit_vector();
    while (next.dot(direction) < -0.9) next = random.unit_vector();
    direction = next;
    at += direction;
    if (i > 0) bonds.push_back({i - 1, i, 1.0});
  }
  start.system = make_system(Eigen::VectorXd::Constant(beads, mass), bonds);
  return start;
}

// A dumbbell of unit masses and unit length along x, turning about z by omega [1/ps].
inline Start rotor(double omega) {
  Start start;
  start.system = make_system(Eigen::VectorXd::Ones(2), {{0, 1, 1.0}});
  State& s = start.state;
  s.x = Vectors::Zero(3, 2);
  s.x(0, 0) = -0.5;
  s.x(0, 1) = 0.5;
  s.v = Vectors::Zero(3, 2);
  s.v(1, 0) = -0.5 * omega;
  s.v(1, 1) = 0.5 * omega;
  s.f = Vectors::Zero(3, 2);
  return start;
}

// Rigid three-site waters (TIP3P's shape and masses), far apart, turning as at `temperature` [K].
inline Start waters(int count, std::uint64_t seed, double temperature) {
  Random random(seed);
  const double oh = 0.09572, half = 0.5 * 104.52 * M_PI / 180;
  const double hh = 2 * oh * std::sin(half);
  Start start;
  State& s = start.state;
  s.x.resize(3, 3 * count);
  s.v.resize(3, 3 * count);
  s.f = Vectors::Zero(3, 3 * count);
  Eigen::VectorXd mass(3 * count);
  std::vector<RigidBond> bonds;
  for (int w = 0; w < count; ++w) {
    const int o = 3 * w;
    mass.segment<3>(o) << 15.99943, 1.007947, 1.007947;
    const Vec3 a = random.unit_vector(), b = a.cross(random.unit_vector()).normalized();
    s.x.col(o) = Vec3(w, 0, 0);
    s.x.col(o + 1) = s.x.col(o) + oh * (std::cos(half) * a + std::sin(half) * b);
    s.x.col(o + 2) = s.x.col(o) + oh * (std::cos(half) * a - std::sin(half) * b);
    for (int i = o; i < o + 3; ++i)
      s.v.col(i) = std::sqrt(0.00831446261815324 * temperature / mass[i]) * random.normal_vector();
    bonds.push_back({o, o + 1, oh});
    bonds.push_back({o, o + 2, oh});
    bonds.push_back({o + 1, o + 2, hh});
  }
  start.system = make_system(std::move(mass), bonds);
  return start;
}

}  // namespace taut::tests
