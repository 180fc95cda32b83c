#include "forcefield/bias.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "base/errors.hpp"
#include "forcefield/bonded/dihedral.hpp"

namespace taut {
namespace {

using enum Bias::Variable;

// Which image of a centre is nearest is settled up to this share of an edge: half an edge, less what centres move
// in many steps.
constexpr double kSettled = 0.49;

constexpr std::array<const char*, 5> kNames = {"distance", "distance", "angle", "torsion", "gyration"};
constexpr std::array<int, 5> kGroups = {2, 2, 3, 4, 1};

// ξ, where the centres are, and ∇ξ by them.
struct Geometry {
  double value = 0;
  bool directed = true;                   // ∇ξ exists
  std::array<Vec3, 4> centre{}, slope{};  // each centre at its image nearest to the one before
  double reach = 0;                       // the farthest of two centres in a row, of nearest images [nm]
};

Vec3 centre_of(const BiasGroup& group, const Vectors& x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < group.atoms.size(); ++k) sum += group.share[k] * x.col(group.atoms[k]);
  return sum;
}

// The axis that a direction is along, where images of the box differ along this axis in one way alone: lattice
// vectors across it have no part in it. −1: none.
int axis_of(const Vec3& along, const Box& box) {
  const Eigen::Matrix3d vectors = box.vectors();
  for (int axis = 0; axis < 3; ++axis) {
    double others = 0;
    for (int d = 0; d < 3; ++d) others += d == axis ? 0 : std::abs(along[d]) + std::abs(vectors(axis, d));
    if (others == 0) return axis;
  }
  return -1;
}

double limit_of(const Bias& bias, const Box& box) {
  return kSettled * (bias.variable == kComponent ? box.edge[axis_of(bias.along, box)] : box.edge.minCoeff());
}

// ∇r = ±d/r
void measure_distance(Geometry& g) {
  const Vec3 d = g.centre[1] - g.centre[0];
  g.value = d.norm();
  g.directed = g.value > 0;
  if (!g.directed) return;
  g.slope[1] = d / g.value;
  g.slope[0] = -g.slope[1];
}

// With arms a and c and p = a × c: θ = atan2(|p|, a·c), ∂θ/∂x_0 = a × p/(a²|p|), ∂θ/∂x_2 = −c × p/(c²|p|).
void measure_angle(Geometry& g) {
  const Vec3 a = g.centre[0] - g.centre[1], c = g.centre[2] - g.centre[1], p = a.cross(c);
  const double sine = p.norm();
  g.value = std::atan2(sine, a.dot(c));
  g.directed = p.squaredNorm() > 1e-20 * a.squaredNorm() * c.squaredNorm();
  if (!g.directed) return;
  g.slope[0] = a.cross(p) / (a.squaredNorm() * sine);
  g.slope[2] = -c.cross(p) / (c.squaredNorm() * sine);
  g.slope[1] = -g.slope[0] - g.slope[2];
}

void measure_torsion(Geometry& g) {
  const Dihedral dihedral(g.centre[0], g.centre[1], g.centre[2], g.centre[3]);
  g.value = dihedral.phi;
  g.slope = {dihedral.grad_i, dihedral.grad_j, dihedral.grad_k, dihedral.grad_l};
  g.directed = !dihedral.grad_i.isZero(0);
}

Geometry measure_centres(const Bias& bias, const Box& box, const Vectors& x) {
  Geometry g;
  g.slope.fill(Vec3::Zero());
  for (std::size_t c = 0; c < bias.groups.size(); ++c) {
    g.centre[c] = centre_of(bias.groups[c], x);
    if (c == 0) continue;
    const Vec3 d = box.nearest_image(g.centre[c] - g.centre[c - 1]);
    g.centre[c] = g.centre[c - 1] + d;
    g.reach = std::max(g.reach, bias.variable == kComponent ? std::abs(bias.along.dot(d)) : d.norm());
  }
  if (bias.variable == kDistance) measure_distance(g);
  if (bias.variable == kAngle) measure_angle(g);
  if (bias.variable == kTorsion) measure_torsion(g);
  if (bias.variable == kComponent) {
    g.value = bias.along.dot(g.centre[1] - g.centre[0]);
    g.slope[1] = bias.along;
    g.slope[0] = -bias.along;
  }
  return g;
}

Geometry measure_gyration(const BiasGroup& group, const Vectors& x) {
  Geometry g;
  g.centre[0] = centre_of(group, x);
  for (std::size_t k = 0; k < group.atoms.size(); ++k)
    g.value += group.share[k] * (x.col(group.atoms[k]) - g.centre[0]).squaredNorm();
  g.value = std::sqrt(g.value);
  g.directed = g.value > 0;
  return g;
}

Geometry measure(const Bias& bias, const Box& box, const Vectors& x) {
  return bias.variable == kGyration ? measure_gyration(bias.groups[0], x) : measure_centres(bias, box, x);
}

// How far a value lies beyond the walls, which are `moved` by now; 0 between them. A torsion's value becomes the
// one of its turns that is nearest to their middle.
double excess_of(const Bias& bias, double moved, double& value) {
  if (bias.variable == kTorsion) {
    const double middle = 0.5 * (bias.lower + bias.upper) + moved;
    value = middle + std::remainder(value - middle, 2 * std::numbers::pi);
  }
  if (value > bias.upper + moved) return value - bias.upper - moved;
  if (value < bias.lower + moved) return value - bias.lower - moved;
  return 0;
}

void spread_on_centres(const Bias& bias, const Geometry& g, double force, Vectors& f,
                       Eigen::Matrix3d& virial) {
  for (std::size_t c = 0; c < bias.groups.size(); ++c) {
    const Vec3 on_centre = force * g.slope[c];
    const auto& [atoms, share] = bias.groups[c];
    for (std::size_t k = 0; k < atoms.size(); ++k) f.col(atoms[k]) += share[k] * on_centre;
    virial += (g.centre[c] - g.centre[0]) * on_centre.transpose();
  }
}

void spread_on_gyration(const BiasGroup& group, const Geometry& g, double force, const Vectors& x, Vectors& f,
                        Eigen::Matrix3d& virial) {
  for (std::size_t k = 0; k < group.atoms.size(); ++k) {
    const Vec3 off = x.col(group.atoms[k]) - g.centre[0];
    const Vec3 on_atom = force * group.share[k] / g.value * off;
    f.col(group.atoms[k]) += on_atom;
    virial += off * on_atom.transpose();
  }
}

[[noreturn]] void refuse_reach(const Bias& bias, double reach, double limit) {
  throw SimulationFailure(fmt::format(
      "bias {}: two of its centres are {:.4g} nm apart, more than {:.4g} nm ({} of the box's edge), "
      "beyond which their nearest images change; take a larger box, or keep them nearer",
      bias.name, reach, limit, kSettled));
}

}  // namespace

const char* name_of(Bias::Variable variable) {
  return kNames[static_cast<std::size_t>(variable)];
}

int groups_of(Bias::Variable variable) {
  return kGroups[static_cast<std::size_t>(variable)];
}

BiasGroup make_group(const System& sys, std::vector<int> atoms) {
  BiasGroup group{std::move(atoms), {}};
  double mass = 0;
  for (const int a : group.atoms) mass += sys.mass[a];
  for (const int a : group.atoms)
    group.share.push_back(mass > 0 ? sys.mass[a] / mass : 1 / static_cast<double>(group.atoms.size()));
  return group;
}

double value_of(const Bias& bias, const Box& box, const Vectors& x) {
  return measure(bias, box, x).value;
}

void add_biases(const std::vector<Bias>& biases, const State& at, Vectors& f, BiasForces& to) {
  to.readings.resize(biases.size());
  to.energy = to.power = 0;
  to.virial.setZero();
  for (std::size_t b = 0; b < biases.size(); ++b) {
    const Bias& bias = biases[b];
    const Geometry g = measure(bias, at.box, at.x);
    BiasReading& reading = to.readings[b];
    reading.value = g.value;
    const double excess = excess_of(bias, bias.rate * (at.t - bias.since), reading.value);
    reading.force = bias.force - bias.k * excess;
    reading.lost = !g.directed && reading.force != 0;
    to.energy += 0.5 * bias.k * excess * excess - bias.force * reading.value;
    to.power -= bias.k * excess * bias.rate;
    if (reading.force == 0 || reading.lost) continue;
    if (at.box.periodic() && bias.variable != kGyration)
      if (const double limit = limit_of(bias, at.box); g.reach > limit) refuse_reach(bias, g.reach, limit);
    if (bias.variable == kGyration)
      spread_on_gyration(bias.groups[0], g, reading.force, at.x, f, to.virial);
    else
      spread_on_centres(bias, g, reading.force, f, to.virial);
  }
}

std::string flaw_of_groups(const Bias& bias, const System& sys) {
  const auto expected = static_cast<std::size_t>(groups_of(bias.variable));
  if (bias.groups.size() != expected)
    return fmt::format("{} groups of atoms, expected {} for {}", bias.groups.size(), expected,
                       name_of(bias.variable));
  std::set<std::set<int>> seen;
  bool moves = false;
  for (std::size_t g = 0; g < bias.groups.size(); ++g) {
    const auto& [atoms, share] = bias.groups[g];
    if (atoms.empty()) return fmt::format("group {} has no atom", g);
    if (share.size() != atoms.size()) return fmt::format("group {} has {} shares", g, share.size());
    std::set<int> named;
    for (const int a : atoms) {
      if (a < 0 || a >= sys.atoms())
        return fmt::format("group {}: there is no atom {}, only 0 to {}", g, a, sys.atoms() - 1);
      if (!named.insert(a).second) return fmt::format("group {} names atom {} twice", g, a);
      moves = moves || !sys.is_anchor(a);
      if (atoms.size() > 1 && sys.reach_of(a) != Reach::kWhole)
        return fmt::format(
            "group {} has atom {}, whose molecule is bonded around the box to its own image and has no "
            "centre: name one atom of it",
            g, a);
    }
    if (!seen.insert(named).second) return fmt::format("group {} has the atoms of an earlier one", g);
  }
  if (bias.variable == kGyration && bias.groups[0].atoms.size() < 2)
    return "a radius of gyration needs two atoms or more";
  return moves ? "" : "its atoms are anchors (mass 0), which do not move";
}

std::string flaw_of_direction(const Bias& bias, const Box& box) {
  if (bias.variable != kComponent) return "";
  if (!bias.along.allFinite() || std::abs(bias.along.norm() - 1) > 1e-9)
    return "its direction is no unit vector";
  if (!box.periodic() || axis_of(bias.along, box) >= 0) return "";
  return "images of this box differ along its direction: expected an axis, as [0, 0, 1], and in a tilted box "
         "one to "
         "which the other lattice vectors are at right angles (z)";
}

std::string flaw_of_walls(const Bias& bias, const Box& box) {
  const double inf = std::numeric_limits<double>::infinity(), pi = std::numbers::pi;
  if (!std::isfinite(bias.k) || bias.k < 0 || !std::isfinite(bias.force) || !std::isfinite(bias.rate) ||
      !std::isfinite(bias.since) || std::isnan(bias.lower) || std::isnan(bias.upper))
    return "a number that is not finite, or a k below 0";
  if (bias.k == 0 && bias.force == 0) return "neither k nor a force: it never acts";
  if (bias.k == 0)
    return bias.variable == kTorsion ? "a constant torque has no energy that fits a full turn" : "";
  if (bias.lower > bias.upper) return "its lower wall lies above the upper one";
  if (bias.lower == -inf && bias.upper == inf) return "it has no wall";
  if (bias.variable == kTorsion && !(bias.upper - bias.lower < 2 * pi))
    return "a torsion goes round: expected both walls, less than a full turn apart";
  if (bias.variable == kTorsion) return "";
  const double least = bias.variable == kComponent ? -inf : 0, most = bias.variable == kAngle ? pi : inf;
  if (bias.upper < least || (bias.lower != -inf && bias.lower > most * (1 + 1e-12)))
    return fmt::format("no value of {} reaches its walls, expected 0 or more{}", name_of(bias.variable),
                       bias.variable == kAngle ? ", up to 180°" : "");
  if (!box.periodic() || bias.variable == kAngle || bias.variable == kGyration) return "";
  const double limit = limit_of(bias, box);
  for (const double wall : {bias.lower, bias.upper})
    if (std::isfinite(wall) && std::abs(wall) > limit)
      return fmt::format("{:.4g} nm is too far, expected at most {:.4g} nm, {} of the box's edge", wall,
                         limit, kSettled);
  return "";
}

}  // namespace taut
