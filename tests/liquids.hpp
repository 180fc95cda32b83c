#pragma once

#include <cmath>
#include <ostream>
#include <random>

#include "forcefield/terms.hpp"
#include "md/box.hpp"

// Liquids of small molecules to compute pairs of.

namespace taut::tests {

struct Liquid {
  const char* name;
  int molecules;   // along an edge, of three atoms
  double spacing;  // [nm]
  bool periodic;
  double cutoff;     // [nm]; 0: none
  double switch_at;  // [nm]; 0: none
  int sigmas;        // kinds of atoms with Lennard-Jones; 0: no Lennard-Jones at all; 3: two, by a table
  bool charges;
  Vec3 tilt = Vec3::Zero();  // of the box, in edges
};

inline void PrintTo(const Liquid& liquid, std::ostream* out) {
  *out << liquid.name;
}

inline Box box_of(const Liquid& liquid) {
  const double edge = liquid.molecules * liquid.spacing;
  return liquid.periodic ? Box{Vec3::Constant(edge), edge * liquid.tilt} : Box{};
}

// Bent molecules of three on a jittered lattice, turned at random, some of them boxes away. No two atoms of
// different molecules come near enough for forces that drown the others.
inline Vectors place(const Liquid& liquid, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const int m = liquid.molecules;
  Vectors x(3, 3 * m * m * m);
  const auto direction = [&] { return Vec3(normal(rng), normal(rng), normal(rng)).normalized(); };
  for (int k = 0; k < m * m * m; ++k) {
    Vec3 o = liquid.spacing * (Vec3(k % m, k / m % m, k / m / m) + 0.06 * direction());
    if (liquid.periodic) o += box_of(liquid).lattice_vector(Vec3(k % 3 - 1, k % 5 - 2, k % 2));
    x.col(3 * k) = o;
    x.col(3 * k + 1) = o + 0.1 * direction();
    x.col(3 * k + 2) = o + 0.1 * direction();
  }
  return x;
}

// Types 0 and 1 meet by numbers no rule of mixing gives; 2 has none.
inline LennardJonesTable table_of(const Nonbonded& nb) {
  LennardJonesTable table{{}, Eigen::MatrixXd::Zero(3, 3), Eigen::MatrixXd::Zero(3, 3)};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double s6 = std::pow(i == j ? 0.25 - 0.04 * i : 0.27, 6), epsilon = i == j ? 0.6 : 0.2;
      table.a(i, j) = 4 * epsilon * s6 * s6;
      table.b(i, j) = 4 * epsilon * s6;
    }
  for (Eigen::Index a = 0; a < nb.epsilon.size(); ++a)
    table.type.push_back(nb.epsilon[a] == 0 ? 2 : static_cast<int>(a / 3 % 2));
  return table;
}

inline Nonbonded forces_of(const Liquid& liquid) {
  const int n = 3 * liquid.molecules * liquid.molecules * liquid.molecules;
  Nonbonded nb;
  nb.charge.setZero(n);
  nb.sigma.setConstant(n, 0.25);
  nb.epsilon.setZero(n);
  for (int a = 0; a < n; ++a) {
    if (liquid.charges) nb.charge[a] = a % 3 == 0 ? -0.8 : 0.4;
    if (liquid.sigmas > 0 && a % 3 == 0) nb.epsilon[a] = a % 2 == 0 ? 0.6 : 0.3;
    if (liquid.sigmas > 1 && a % 3 == 0) nb.sigma[a] = a % 4 == 0 ? 0.25 : 0.21;
    if (a % 3 != 0) nb.exceptions.push_back({a - a % 3, a, 0, 1, 0});
    if (a % 3 == 2) nb.exceptions.push_back({a - 1, a, 0, 1, 0});
    if (a % 9 == 3) nb.exceptions.push_back({a, (a + 5) % n, 0, 1, 0});
  }
  if (liquid.sigmas == 3) nb.lj_table = table_of(nb);
  if (liquid.cutoff > 0) nb.cutoff = liquid.cutoff;
  if (liquid.switch_at > 0) nb.switch_distance = liquid.switch_at;
  return nb;
}

inline double rms(const Vectors& f) {
  return f.norm() / std::sqrt(f.size());
}

}  // namespace taut::tests
