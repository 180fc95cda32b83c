#pragma once

#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "md/state.hpp"
#include "md/system.hpp"
#include "md/units.hpp"

namespace taut::bench {

// Molecules on a lattice, thermal velocities, no forces between them: what constraints cost and nothing else.
class Molecules {
 public:
  explicit Molecules(int atoms) : mass_(atoms) {
    state_.x.resize(3, atoms);
    state_.v.resize(3, atoms);
    state_.f = Vectors::Zero(3, atoms);
  }

  // Places the next atom; velocity of variance kT/m.
  int add(const Vec3& x, double mass, double kT) {
    state_.x.col(next_) = x;
    state_.v.col(next_) = std::sqrt(kT / mass) * random_.normal_vector();
    mass_[next_] = mass;
    return next_++;
  }
  void bond(int i, int j) { bonds_.push_back({i, j, (state_.x.col(j) - state_.x.col(i)).norm()}); }
  void bond(int i, int j, double length) { bonds_.push_back({i, j, length}); }

  Random& random() { return random_; }
  System system() const { return make_system(mass_, bonds_); }
  const State& state() const { return state_; }

 private:
  Random random_{1};
  Eigen::VectorXd mass_;
  State state_;
  std::vector<RigidBond> bonds_;
  int next_ = 0;
};

// Corner n of a cubic lattice that holds `count` corners.
inline Vec3 lattice_point(int n, int count, double spacing) {
  const int side = static_cast<int>(std::ceil(std::cbrt(count)));
  return spacing * Vec3(n % side, n / side % side, n / side / side);
}

// Freely jointed, unit bonds, masses and kT, kept to boxes of a few bonds so that coordinates stay small.
inline Molecules chains(int count, int bonds) {
  Molecules m(count * (bonds + 1));
  for (int c = 0; c < count; ++c) {
    Vec3 at = lattice_point(c, count, 5);
    const Vec3 home = at;
    int last = m.add(at, 1, 1);
    for (int b = 0; b < bonds; ++b) {
      Vec3 next = m.random().unit_vector();
      while ((at + next - home).norm() > 10) next = m.random().unit_vector();
      at += next;
      const int atom = m.add(at, 1, 1);
      m.bond(last, atom, 1);
      last = atom;
    }
  }
  return m;
}

// Puckered rings of unit bonds, nearly.
inline Molecules rings(int count, int bonds) {
  Molecules m(count * bonds);
  const double radius = 0.5 / std::sin(std::numbers::pi / bonds);
  for (int c = 0; c < count; ++c) {
    const Vec3 centre = lattice_point(c, count, 3 * radius);
    int first = 0;
    for (int b = 0; b < bonds; ++b) {
      const double phi = 2 * std::numbers::pi * b / bonds;
      const int atom =
          m.add(centre + Vec3(radius * std::cos(phi), radius * std::sin(phi), 0.15 * (b % 2)), 1, 1);
      if (b == 0) first = atom;
    }
    const double length = std::hypot(1, 0.15);
    for (int b = 0; b < bonds; ++b) m.bond(first + b, first + (b + 1) % bonds, length);
  }
  return m;
}

// A backbone of `bonds`/2 with a side group of one bond at every bead.
inline Molecules combs(int count, int bonds) {
  Molecules m(count * (bonds + 1));
  for (int c = 0; c < count; ++c) {
    Vec3 at = lattice_point(c, count, 5);
    int bead = m.add(at, 1, 1);
    for (int b = 0; b < bonds / 2; ++b) {
      const int side = m.add(at + m.random().unit_vector(), 1, 1);
      m.bond(bead, side, 1);
      at += m.random().unit_vector();
      const int next = m.add(at, 1, 1);
      m.bond(bead, next, 1);
      bead = next;
    }
  }
  return m;
}

// TIP3P's shape at 300 K.
inline Molecules waters(int count) {
  Molecules m(3 * count);
  const double oh = 0.09572, half = 0.5 * 104.52 * std::numbers::pi / 180, kT = 300 * kBoltzmann;
  for (int w = 0; w < count; ++w) {
    const Vec3 at = lattice_point(w, count, 0.31);
    const Vec3 a = m.random().unit_vector(), b = a.cross(m.random().unit_vector()).normalized();
    const int o = m.add(at, 15.99943, kT);
    m.add(at + oh * (std::cos(half) * a + std::sin(half) * b), 1.007947, kT);
    m.add(at + oh * (std::cos(half) * a - std::sin(half) * b), 1.007947, kT);
    m.bond(o, o + 1, oh);
    m.bond(o, o + 2, oh);
    m.bond(o + 1, o + 2, 2 * oh * std::sin(half));
  }
  return m;
}

}  // namespace taut::bench
