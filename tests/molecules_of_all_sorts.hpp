#pragma once

// Molecules with rigid bonds, of every shape that the fast forms tell apart.

#include "against_plain.hpp"

namespace taut {

// Hexagons, puckered and turning; every second one with an arm.
inline std::vector<Start> rings(int count) {
  std::vector<Start> rings;
  for (int c = 0; c < count; ++c) {
    Start start = tests::free_chain(7, 30 + c);
    for (int i = 0; i < 6; ++i)
      start.state.x.col(i) << std::cos(M_PI * i / 3), std::sin(M_PI * i / 3), 0.1 * (i % 2);
    start.state.x.col(6) << 2, 0.1, 0.1 * c;
    auto bonds = start.system.bonds;
    bonds.pop_back();
    bonds.push_back({5, 0, 1.0});
    if (c % 2 == 0) bonds.push_back({6, 0, 1.0});
    Eigen::VectorXd mass = start.system.mass;
    mass[3] = 4;
    start.system = make_system(mass, bonds);
    rings.push_back(start);
  }
  return rings;
}

// A centre of mass 20 with three arms, the last of two bonds.
inline std::vector<Start> trees(int count) {
  std::vector<Start> trees;
  for (int c = 0; c < count; ++c) {
    Start start = tests::free_chain(5, 50 + c);
    start.state.x << 0, 1, -0.5, -0.5, -1.1, 0, 0, 0.87, -0.87, -0.9, 0, 0.1, 0, 0, 0.8;
    Eigen::VectorXd mass(5);
    mass << 20, 1, 2, 1, 1;
    start.system = make_system(mass, {{0, 1, 1}, {2, 0, 1}, {0, 3, 1}, {4, 3, 1}});
    trees.push_back(start);
  }
  return trees;
}

// A centre with three arms, bonds 0–1, 0–2, 0–3: as many bonds as a triangle.
inline std::vector<Start> stars(int count) {
  std::vector<Start> stars;
  for (int c = 0; c < count; ++c) {
    Start start = tests::free_chain(4, 40 + c);
    start.state.x << 0, 1, -0.5, -0.5, 0, 0, 0.87, -0.87, 0, 0.1, 0, 0;
    start.system = make_system(start.system.mass, {{0, 1, 1}, {0, 2, 1}, {0, 3, 1}});
    stars.push_back(start);
  }
  return stars;
}

// Dumbbells alike in all but their length, their masses or which of the two is the heavy one.
inline std::vector<Start> dumbbells_of_all_sorts() {
  std::vector<Start> all;
  for (const double length : {1.0, 1.5})
    for (const double first : {1.0, 3.0})
      for (const double second : {1.0, 3.0}) {
        Start start = tests::rotor(1 + first);
        start.state.x *= length;
        start.system = make_system(Eigen::VectorXd{{first, second}}, {{0, 1, length}});
        all.push_back(start);
      }
  return all;
}

// Bonds of which the second and the last but one have each other's number.
inline std::vector<Start> renumbered(std::vector<Start> all) {
  for (Start& start : all) {
    auto bonds = start.system.bonds;
    std::swap(bonds[1], bonds.end()[-2]);
    start.system = make_system(start.system.mass, bonds);
  }
  return all;
}

inline std::vector<Start> pinned_chains(int count) {
  std::vector<Start> pinned = chains(count, 5, 70);
  for (Start& start : pinned) {
    Eigen::VectorXd mass = start.system.mass;
    mass[0] = 0;
    start.state.v.col(0).setZero();
    start.system = make_system(mass, start.system.bonds);
  }
  return pinned;
}

// Two chains alike from one anchor, which holds both.
inline Start from_one_anchor() {
  Start start = tests::free_chain(9, 60);
  State& s = start.state;
  Eigen::VectorXd mass = start.system.mass;
  mass[0] = 0;
  s.v.col(0).setZero();
  s.x.rightCols(4).colwise() -= Vec3(s.x.col(4) - s.x.col(0));
  auto bonds = start.system.bonds;
  bonds[4].i = 0;
  start.system = make_system(mass, bonds);
  return start;
}

inline std::vector<Start> between(std::vector<Start> first, const std::vector<Start>& middle,
                                  const std::vector<Start>& last) {
  first.insert(first.end(), middle.begin(), middle.end());
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

inline std::vector<Start> waters_alike(int count, const Vec3& masses) {
  std::vector<Start> waters;
  for (int w = 0; w < count; ++w) {
    Start water = tests::waters(1, 80 + w, 300);
    water.system = make_system(masses, water.system.bonds);
    waters.push_back(water);
  }
  return waters;
}

// With an atom on its own after each.
inline std::vector<Start> apart(const std::vector<Start>& molecules) {
  Start atom;
  atom.state.x = atom.state.v = atom.state.f = Vectors::Zero(3, 1);
  atom.system = make_system(Eigen::VectorXd::Ones(1), {});
  std::vector<Start> all;
  for (const Start& molecule : molecules) all.insert(all.end(), {molecule, atom});
  return all;
}

}  // namespace taut
