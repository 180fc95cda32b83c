#include "systems/builders/solvent.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/listen.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/molecules/occupied_space.hpp"

namespace taut {
namespace {

constexpr double kNearest = 0.2;                   // smallest distance of two O [nm]
constexpr double kTooWide = 1.02;                  // factor by which an edge is cut too wide
constexpr double kTooNear = 0.3;                   // one of two O nearer than this is removed first [nm]
constexpr double kLongestMove = 0.02, kArm = 0.1;  // [nm]
constexpr int kMostMoves = 1000;
constexpr double kSlack = 0.05;  // of a molecule's energy, less than a kelvin [kJ/mol]

// Returns the waters with these numbers.
State chosen(const State& all, const std::vector<Eigen::Index>& numbers) {
  State some;
  some.box = all.box;
  some.x.resize(3, 3 * numbers.size());
  some.v.resize(3, 3 * numbers.size());
  for (std::size_t m = 0; m < numbers.size(); ++m) {
    some.x.middleCols<3>(3 * m) = all.x.middleCols<3>(3 * numbers[m]);
    some.v.middleCols<3>(3 * m) = all.v.middleCols<3>(3 * numbers[m]);
  }
  return some;
}

// Removes so many waters, each time the later one of the nearest pair.
State thinned(const State& waters, long surplus) {
  struct Pair {
    double apart;
    int first, second;
  };
  std::vector<Pair> pairs;
  OccupiedSpace space(waters.box, kTooNear / 2);
  const int count = static_cast<int>(waters.x.cols() / 3);
  for (int m = 0; m < count; ++m) {
    const Vec3 o = waters.x.col(3 * m);
    space.is_free(o, kTooNear / 2, [&](int other) {
      pairs.push_back({waters.box.nearest_image(o - waters.x.col(3 * other)).norm(), other, m});
      return true;
    });
    space.add(o, kTooNear / 2);
  }
  std::ranges::stable_sort(pairs, {}, &Pair::apart);
  std::vector<bool> out(count);
  for (const auto& [apart, first, second] : pairs) {
    if (surplus == 0) break;
    if (out[first] || out[second]) continue;
    out[second] = true;
    --surplus;
  }
  std::vector<Eigen::Index> left;
  for (int m = 0; m < count; ++m)
    if (!out[m]) left.push_back(m);
  left.resize(left.size() - surplus);
  return chosen(waters, left);
}

}  // namespace

bool remove_sites(State& waters) {
  Vectors& x = waters.x;
  Eigen::Index each = 0;
  while (each < x.cols() && (x.col(each) - x.col(0)).norm() < kNearest) ++each;
  if (each < 3 || x.cols() % each != 0) return false;
  const Eigen::Index molecules = x.cols() / each;
  for (Vectors* of : {&x, &waters.v}) {
    for (Eigen::Index m = 0; m < molecules; ++m)
      of->middleCols<3>(3 * m) = of->middleCols<3>(each * m).eval();
    of->conservativeResize(3, 3 * molecules);
  }
  return true;
}

State tiled(const State& unit, int n) {
  const Eigen::Index atoms = unit.x.cols();
  Vectors home = unit.x;
  for (Eigen::Index o = 0; o < atoms; o += 3) {
    home.middleCols(o, 3).colwise() -= unit.box.lattice_vector(unit.box.cell_of(unit.x.col(o), std::floor));
  }
  State all;
  all.box = unit.box.scaled(Vec3::Constant(n));
  all.x.resize(3, atoms * n * n * n);
  all.v = unit.v.replicate(1, n * n * n);
  for (int t = 0; t < n * n * n; ++t)
    all.x.middleCols(t * atoms, atoms) = home.colwise() + unit.box.lattice_vector(cube_cell(t, n));
  return all;
}

// The images of a tilted box extend further sideways.
State cut(const State& unit, const Box& box) {
  const int n = static_cast<int>(std::ceil((box.edge.array() / unit.box.edge.array()).maxCoeff()));
  const int least = unit.box.tilt.isZero(0) ? 0 : -n, most = unit.box.tilt.isZero(0) ? n : 2 * n + 1;
  std::vector<Eigen::Index> numbers;
  std::vector<Vec3> moves;
  for (int c = least; c < most; ++c)
    for (int b = least; b < most; ++b)
      for (int a = least; a < most; ++a)
        for (Eigen::Index m = 0; m < unit.x.cols() / 3; ++m) {
          const Vec3 o = unit.x.col(3 * m);
          const Vec3 move = unit.box.lattice_vector(Vec3(a, b, c) - unit.box.cell_of(o, std::floor));
          const auto there = (o + move).array();
          if (!(there >= 0).all() || !(there < box.edge.array()).all()) continue;
          numbers.push_back(m);
          moves.push_back(move);
        }
  State waters = chosen(unit, numbers);
  waters.box = box;
  for (std::size_t m = 0; m < moves.size(); ++m) waters.x.middleCols<3>(3 * m).colwise() += moves[m];
  return waters;
}

State cut(const State& unit, const Box& box, long molecules) {
  double wide = kTooWide;
  State waters = cut(unit, box.scaled(Vec3::Constant(wide)));
  while (waters.x.cols() < 3 * molecules) {
    wide *= kTooWide;
    waters = cut(unit, box.scaled(Vec3::Constant(wide)));
  }
  waters = thinned(waters, waters.x.cols() / 3 - molecules);
  waters.box = box;
  for (Eigen::Index o = 0; o < waters.x.cols(); o += 3)
    waters.x.middleCols<3>(o).colwise() -= (1 - 1 / wide) * waters.x.col(o).eval();
  return waters;
}

bool relax(const System& sys, ForceField& forces, const std::vector<RigidMolecules>& molecules, double energy,
           State& s) {
  s.f.resizeLike(s.x);
  double now = forces.evaluate_energy(sys, s), far = 1e-5;  // [nm per kJ/mol/nm]
  State next = s;
  double slack = 0;
  for (const RigidMolecules& of : molecules) slack += kSlack * static_cast<double>(of.count());
  for (int move = 0; move < kMostMoves && now > energy + slack; ++move) {
    hear();
    for (const auto& [first, last, each] : molecules)
      for (Eigen::Index m = first; m < last; m += each) {
        const auto x = s.x.middleCols(m, each), f = s.f.middleCols(m, each);
        const Vec3 middle = x.rowwise().mean(), force = f.rowwise().sum();
        Vec3 torque = Vec3::Zero();
        for (int a = 0; a < each; ++a) torque += Vec3(x.col(a) - middle).cross(Vec3(f.col(a)));
        const double longest =
            kLongestMove / std::max({far * force.norm(), far * torque.norm() / kArm, kLongestMove});
        const Vec3 turn = longest * far / (kArm * kArm) * torque;
        const Eigen::Matrix3d turned =
            Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()).toRotationMatrix();
        next.x.middleCols(m, each) =
            (turned * (x.colwise() - middle)).colwise() + (middle + longest * far * force);
      }
    const double there = forces.evaluate_energy(sys, next);
    if (!(there < now) || there < energy - slack) {
      far *= there < now ? (now - energy) / (now - there) : 0.5;
      continue;
    }
    std::swap(s, next);
    now = there;
    far *= 1.2;
  }
  return now <= energy + slack;
}

}  // namespace taut
