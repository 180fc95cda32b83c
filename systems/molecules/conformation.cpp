#include "systems/molecules/conformation.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "base/errors.hpp"
#include "forcefield/bonded/dihedral.hpp"
#include "systems/molecules/rows.hpp"

namespace taut {
namespace {

constexpr int kDirections = 64;       // trial directions for every atom
constexpr int kShapes = 100;          // trials before the molecule is refused
constexpr int kSweeps = 4000;         // most sweeps over all distances
constexpr double kClosed = 1e-10;     // relative error of a length
constexpr double kTouch = 0.85 / 2;   // radius of a sphere, in σ: two come as near as 0.85 σ in a liquid
constexpr double kBareCharge = 0.05;  // radius of a charge without Lennard-Jones [nm]

Vec3 at_angle(const Vec3& axis, double angle, Random& random) {
  const Vec3 u = axis.normalized(), w = random.unit_vector();
  return std::cos(angle) * u + std::sin(angle) * (w - w.dot(u) * u).normalized();
}

// Draws an angle θ with the weight exp(−κ(1 + cos θ)) of a cosine angle: of its cosine −1 − ln(1 − u(1 − e⁻²ᵏ))/κ, u
// uniform.
double draw_bend(double kappa, Random& random) {
  constexpr double kFree = 1e-6;
  const double u = random.uniform();
  const double cosine = !(kappa > kFree) ? 2 * u - 1 : -1 - std::log1p(u * std::expm1(-2 * kappa)) / kappa;
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

Eigen::Matrix3d random_turn(Random& random) {  // Shoemake 1992, doi:10.1016/B978-0-08-050755-2.50036-1
  const double s = random.uniform(), a = 2 * std::numbers::pi * random.uniform(),
               b = 2 * std::numbers::pi * random.uniform();
  const double p = std::sqrt(1 - s), q = std::sqrt(s);
  return Eigen::Quaterniond(q * std::cos(b), p * std::sin(a), p * std::cos(a), q * std::sin(b))
      .toRotationMatrix();
}

double radius_of(const Molecule& molecule, int a) {
  if (!molecule.terms.nonbonded) return 0;
  const Nonbonded& pairs = *molecule.terms.nonbonded;
  if (pairs.epsilon[a] > 0) return kTouch * pairs.sigma[a];
  return pairs.charge[a] != 0 ? kBareCharge : 0;
}

}  // namespace

Conformations::Conformations(const Molecule& molecule, double kT)
    : molecule_(molecule), kT_(kT), shaped_(molecule.x.cols() > 0), near_(molecule.atoms()) {
  for (int a = 0; a < molecule.atoms(); ++a) radius_.push_back(radius_of(molecule, a));
  if (shaped_) return;
  const auto may_overlap = [&](int i, int j) {
    near_[i].push_back(j);
    near_[j].push_back(i);
  };
  for (const Tie& tie : list_ties(molecule)) may_overlap(tie.i, tie.j);
  for (const Bend& bend : list_bends(molecule)) may_overlap(bend.i, bend.k);
  for (const auto& angle : molecule.terms.cosine_angles) may_overlap(angle.i, angle.k);
  if (molecule.terms.nonbonded)
    for (const auto& pair : molecule.terms.nonbonded->exceptions) may_overlap(pair.i, pair.j);
  for (auto& near : near_) std::ranges::sort(near);
  plan_torsions();
  plan_growth();
  plan_distances();
  Random random(1);
  for (int shape = 0; shape < kShapes; ++shape) {
    OccupiedSpace empty({}, widest());
    if (place_copy(Vec3::Zero(), shape < kShapes / 2 ? 1 : 0.5, empty, random)) return;
  }
  throw InputError(
      "no shape found in which all bonds have their lengths, struts and ropes too, and no atoms overlap; "
      "give "
      "coordinates_nm or file");
}

void Conformations::plan_torsions() {
  const auto add = [&](const auto& list, auto member) {
    for (const auto& term : list) {
      Torsion& torsion = torsions_.emplace_back(Torsion{{term.i, term.j, term.k, term.l}});
      torsion.*member = term;
    }
  };
  add(molecule_.terms.torsions, &Torsion::periodic);
  add(molecule_.terms.rb_torsions, &Torsion::powers);
  add(molecule_.terms.harmonic_torsions, &Torsion::harmonic);
}

// The atom by which ties to an atom are grown: itself, or the one that a site is nearest to.
int Conformations::grown_for(int atom) const {
  const std::vector<Weighted> atoms = weighted_atoms_of(molecule_.system.sites, atom);
  if (atoms.empty())
    throw InputError(fmt::format(
        "atom {} is tied, and is a virtual site out of the plane of its parents, from which no shape can be "
        "grown; give coordinates_nm or file",
        atom));
  return std::ranges::max_element(atoms, {}, &Weighted::weight)->atom;
}

// Orders atoms breadth first from the first that is no virtual site; sites come last.
void Conformations::plan_growth() {
  const System& sys = molecule_.system;
  std::vector<std::vector<std::pair<int, double>>> next(molecule_.atoms());
  for (const auto& [i, j, length, k, slack] : list_ties(molecule_)) {
    closes_ = closes_ || sys.is_site(i) || sys.is_site(j);
    const int from = grown_for(i), to = grown_for(j);
    const double grown =
        length == 0 && k > 0 ? std::sqrt(3 * kT_ / k) : length;  // √⟨r²⟩ of a spring of length 0
    next[from].emplace_back(to, grown);
    next[to].emplace_back(from, grown);
  }
  std::vector<int> rank(molecule_.atoms(), -1);
  int root = 0;
  while (sys.is_site(root)) ++root;
  order_.push_back({root});
  rank[root] = 0;
  for (std::size_t k = 0; k < order_.size(); ++k)
    for (const auto& [atom, length] : next[order_[k].atom]) {
      if (rank[atom] >= 0) continue;
      rank[atom] = static_cast<int>(order_.size());
      order_.push_back({atom, order_[k].atom, -1, length});
    }
  if (order_.size() + sys.sites.size() < static_cast<std::size_t>(molecule_.atoms()))
    throw InputError(
        "some parents of virtual sites are tied to no other atom, so that no shape can be grown; give "
        "coordinates_nm or file");
  for (const VirtualSite& site : sys.sites) {
    rank[site.atom] = static_cast<int>(order_.size());
    order_.push_back({.atom = site.atom, .parent = root, .is_site = true});
  }
  closes_ = closes_ || std::ssize(list_ties(molecule_)) > molecule_.atoms() - 1 - std::ssize(sys.sites);
  for (const auto& [i, j, k, angle] : list_bends(molecule_)) {
    const int last = rank[i] > rank[k] ? i : k;
    Growth& growth = order_[rank[last]];
    if (growth.parent != j || growth.is_site) continue;
    closes_ = closes_ || growth.grand >= 0;
    growth.grand = last == i ? k : i;
    growth.angle = angle;
  }
  for (const auto& [i, j, k, stiffness] : molecule_.terms.cosine_angles) {
    const int last = rank[i] > rank[k] ? i : k;
    Growth& growth = order_[rank[last]];
    if (growth.parent != j || growth.is_site || growth.grand >= 0) continue;
    growth.grand = last == i ? k : i;
    growth.bend = stiffness / kT_;
  }
  for (const OneSidedBond& bond : molecule_.system.one_sided)
    order_[std::max(rank[bond.i], rank[bond.j])].one_sided.push_back(bond);
  for (std::size_t t = 0; t < torsions_.size(); ++t) {
    int last = 0;
    for (const int a : torsions_[t].atoms) last = std::max(last, rank[a]);
    if (order_[last].is_site) continue;
    order_[last].torsions.push_back(static_cast<int>(t));
  }
}

Conformations::Distance Conformations::distance(int i, int j, double length, bool tie) const {
  Distance distance{weighted_atoms_of(molecule_.system.sites, j), length, tie};
  for (const auto& [atom, weight] : weighted_atoms_of(molecule_.system.sites, i)) {
    const auto known = std::ranges::find(distance.atoms, atom, &Weighted::atom);
    if (known == distance.atoms.end())
      distance.atoms.push_back({atom, -weight});
    else
      known->weight -= weight;
  }
  return distance;
}

void Conformations::plan_distances() {
  std::map<std::pair<int, int>, double> length;
  for (const Tie& tie : list_ties(molecule_)) {
    if (tie.length == 0) continue;
    length[std::minmax(tie.i, tie.j)] = tie.length;
    distances_.push_back(distance(tie.i, tie.j, tie.length, true));
  }
  for (const auto& [i, j, k, angle] : list_bends(molecule_)) {
    const auto a = length.find(std::minmax(i, j)), b = length.find(std::minmax(j, k));
    if (a == length.end() || b == length.end() || length.contains(std::minmax(i, k))) continue;
    const double p = a->second, q = b->second;
    distances_.push_back(distance(i, k, std::sqrt(p * p + q * q - 2 * p * q * std::cos(angle)), false));
  }
}

std::optional<Vectors> Conformations::place_copy(const Vec3& at, double scale, OccupiedSpace& space,
                                                 Random& random) const {
  if (shaped_) {
    const Vec3 middle = molecule_.x.rowwise().mean();
    return place_rigid((random_turn(random) * (molecule_.x.colwise() - middle)).colwise() + at, scale, space);
  }
  if (!closes_) return grow(at, scale, space, random);
  OccupiedSpace alone({}, widest());
  auto shape = grow(at, 0, alone, random);
  if (!shape || !close_rings(*shape)) return {};
  place_sites(molecule_.system.sites, *shape);
  if (!all_satisfied(molecule_.system.one_sided, *shape)) return {};
  return place_rigid(std::move(*shape), scale, space);
}

std::optional<Vectors> Conformations::place_rigid(Vectors x, double scale, OccupiedSpace& space) const {
  const int first = space.size();
  for (int a = 0; a < x.cols(); ++a) {
    const auto may = [&](int n) { return n >= first && (shaped_ || may_be_near(a, n - first)); };
    if (!has_room(a, x.col(a), space) || !space.is_free(x.col(a), scale * radius_[a], may)) {
      space.remove_from(first);
      return {};
    }
    space.add(x.col(a), scale * radius_[a]);
  }
  return x;
}

// Chooses one of several directions with a probability proportional to its weight w: the one with the
// smallest −ln w + ln(−ln u), u uniform (the Gumbel trick, which needs no sum).
std::optional<Vectors> Conformations::grow(const Vec3& at, double scale, OccupiedSpace& space,
                                           Random& random) const {
  const int first = space.size();
  Vectors x(3, molecule_.atoms());
  bool sites_placed = false;
  for (const Growth& growth : order_) {
    const double radius = scale * radius_[growth.atom];
    const auto may = [&](int n) { return n >= first && may_be_near(growth.atom, order_[n - first].atom); };
    Vec3 best = Vec3::Zero();
    double least = std::numeric_limits<double>::infinity();
    if (growth.is_site) {
      if (!std::exchange(sites_placed, true)) place_sites(molecule_.system.sites, x);
      best = x.col(growth.atom);
      if (has_room(growth.atom, best, space) && space.is_free(best, radius, may)) least = 0;
    }
    for (int k = 0; k < (growth.is_site ? 0 : growth.parent < 0 ? 1 : kDirections); ++k) {
      auto here = x.col(growth.atom);
      here = at;
      if (growth.parent >= 0) {
        const Vec3 parent = x.col(growth.parent);
        const double angle = growth.bend ? draw_bend(*growth.bend, random) : growth.angle;
        here = parent + growth.length * (growth.grand < 0
                                             ? random.unit_vector()
                                             : at_angle(x.col(growth.grand) - parent, angle, random));
      }
      if (!has_room(growth.atom, here, space) || !space.is_free(here, radius, may) ||
          !all_satisfied(growth.one_sided, x))
        continue;
      if (growth.torsions.empty()) {
        best = here, least = 0;
        break;
      }
      double cost = std::log(-std::log(1 - random.uniform()));
      for (const int t : growth.torsions) cost += energy(torsions_[t], x) / kT_;
      if (cost < least || least == std::numeric_limits<double>::infinity()) least = cost, best = here;
    }
    if (least == std::numeric_limits<double>::infinity()) {
      space.remove_from(first);
      return {};
    }
    x.col(growth.atom) = best;
    space.add(best, radius);
  }
  return x;
}

bool Conformations::all_satisfied(const std::vector<OneSidedBond>& bonds, const Vectors& x) {
  return std::ranges::all_of(bonds, [&](const OneSidedBond& bond) { return is_satisfied(bond, x); });
}

// First with the angles, which may contradict each other; then with the ties alone.
bool Conformations::close_rings(Vectors& x) const {
  double worst = 1;
  for (const bool ties_alone : {false, true}) {
    worst = 1;
    for (int sweep = 0; sweep < kSweeps && worst > kClosed; ++sweep) {
      worst = 0;
      for (const auto& [atoms, length, tie] : distances_) {
        if (ties_alone && !tie) continue;
        Vec3 d = Vec3::Zero();
        double squares = 0;
        for (const auto& [a, c] : atoms) d += c * x.col(a), squares += c * c;
        const double r = d.norm(), off = r - length;
        worst = std::max(worst, std::abs(off) / length);
        if (r == 0) return false;
        for (const auto& [a, c] : atoms) x.col(a) -= c / squares * off / r * d;
      }
    }
  }
  return worst <= kClosed;
}

double Conformations::energy(const Torsion& torsion, const Vectors& x) const {
  const auto& [i, j, k, l] = torsion.atoms;
  const double phi = Dihedral(x.col(i), x.col(j), x.col(k), x.col(l)).phi;
  double sum = torsion.periodic.amplitude *
               (1 + std::cos(torsion.periodic.periodicity * phi - torsion.periodic.phase));
  double power = 1;
  for (const double c : torsion.powers.c) {
    sum += c * power;
    power *= -std::cos(phi);
  }
  const double off = std::remainder(phi - torsion.harmonic.angle, 2 * std::numbers::pi);
  return sum + 0.5 * torsion.harmonic.stiffness * off * off;
}

bool Conformations::has_room(int atom, const Vec3& x, const OccupiedSpace& space) const {
  return molecule_.system.is_anchor(atom) || space.is_between_walls(x);
}

bool Conformations::may_be_near(int a, int b) const {
  return std::ranges::binary_search(near_[a], b);
}

double Conformations::widest() const {
  return radius_.empty() ? 0 : *std::ranges::max_element(radius_);
}

double Conformations::extent() const {
  double across = 0;
  if (shaped_) {
    const Vec3 middle = molecule_.x.rowwise().mean();
    across = 2 * (molecule_.x.colwise() - middle).colwise().norm().maxCoeff();
  } else {
    double longest = 0;
    for (const Growth& growth : order_) longest = std::max(longest, growth.length);
    across = longest * std::min(std::max(molecule_.atoms() - 1.0, 0.0), 3 * std::sqrt(molecule_.atoms()));
  }
  return across + 8 * widest();
}

}  // namespace taut
