#include "systems/molecules/linked_rings.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/adjacency.hpp"
#include "base/listen.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

constexpr std::size_t kFewest = 8;  // atoms of a ring through which another fits

struct Ring {
  int atom;        // one of them
  Vectors x;       // of its atoms in their order, whole [nm]
  Vec3 low, high;  // in edges of the box; without a box in nm
};

std::vector<BondedPair> drawn_bonds(const System& sys, const Terms& terms) {
  std::vector<BondedPair> pairs = further_bonds(sys, terms);
  for (const RigidBond& bond : sys.bonds) pairs.push_back({bond.i, bond.j});
  for (BondedPair& pair : pairs) std::ranges::sort(pair);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

// The rings that are left when side chains are taken off atom by atom. Where rings share atoms there is none.
std::vector<std::vector<int>> rings_of(int atoms, const Adjacency& next) {
  std::vector<int> ties(static_cast<std::size_t>(atoms)), ends;
  for (int a = 0; a < atoms; ++a) {
    ties[a] = next.begin[a + 1] - next.begin[a];
    if (ties[a] == 1) ends.push_back(a);
  }
  const auto each = [&](int a, const auto& act) {
    for (int k = next.begin[a]; k < next.begin[a + 1]; ++k)
      if (ties[next.partner[k]] > 0) act(next.partner[k]);
  };
  while (!ends.empty()) {
    const int end = ends.back();
    ends.pop_back();
    ties[end] = 0;
    each(end, [&](int other) {
      if (--ties[other] == 1) ends.push_back(other);
    });
  }
  std::vector<std::vector<int>> rings;
  std::vector<bool> seen(static_cast<std::size_t>(atoms));
  for (int a = 0; a < atoms; ++a) {
    if (ties[a] != 2 || seen[a]) continue;
    std::vector<int> ring;
    for (int at = a; at >= 0;) {
      seen[at] = true;
      ring.push_back(at);
      int further = -1;
      each(at, [&](int other) {
        if (ties[other] == 2 && !seen[other]) further = other;
      });
      at = further;
    }
    bool closed = false;
    each(ring.back(), [&](int other) { closed = closed || other == a; });
    if (closed && ring.size() >= kFewest) rings.push_back(std::move(ring));
  }
  return rings;
}

Ring place_ring(const std::vector<int>& atoms, const Box& box, const Vectors& x) {
  Ring ring{atoms[0], Vectors(3, atoms.size()), {}, {}};
  ring.x.col(0) = x.col(atoms[0]);
  for (std::size_t k = 1; k < atoms.size(); ++k) {
    const auto before = ring.x.col(static_cast<Eigen::Index>(k) - 1);
    ring.x.col(static_cast<Eigen::Index>(k)) = before + box.nearest_image(x.col(atoms[k]) - before);
  }
  Vectors cells = ring.x;
  if (box.periodic())
    for (Eigen::Index k = 0; k < cells.cols(); ++k) cells.col(k) = box.fractional(ring.x.col(k));
  ring.low = cells.rowwise().minCoeff();
  ring.high = cells.rowwise().maxCoeff();
  if (!box.periodic()) return ring;
  const Vec3 whole = ring.low.array().floor();
  ring.low -= whole, ring.high -= whole;
  ring.x.colwise() -= box.lattice_vector(whole);
  return ring;
}

// Axes along which no lattice has its rows, so that no two bonds of a regular start cover each other.
Eigen::Matrix3d odd_axes() {
  return (Eigen::AngleAxisd(0.7391, Vec3(0.36, 0.48, 0.8)) * Eigen::AngleAxisd(1.1237, Vec3::UnitX()))
      .toRotationMatrix();
}

double cross(const Vec3& a, const Vec3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Gauss's linking number, as the number of times that one ring crosses over the other, seen along z, each with the sign
// of the turn from the upper to the lower bond (Rolfsen, Knots and Links, 1976, 5D).
int linking_number(const Vectors& upper, const Vectors& lower) {
  const auto bonds = [](const Vectors& ring) {
    std::vector<std::pair<Vec3, Vec3>> all;
    for (Eigen::Index k = 0; k < ring.cols(); ++k)
      all.emplace_back(ring.col(k), ring.col((k + 1) % ring.cols()));
    return all;
  };
  const auto left = [](const auto& bond) { return std::min(bond.first.x(), bond.second.x()); };
  auto below = bonds(lower);
  std::ranges::sort(below, {}, left);
  double longest = 0;
  for (const auto& [q, to] : below) longest = std::max(longest, std::abs(to.x() - q.x()));
  int sum = 0;
  for (const auto& bond : bonds(upper)) {
    const auto& [p, p_to] = bond;
    const double right = std::max(p.x(), p_to.x());
    for (auto other = std::ranges::lower_bound(below, left(bond) - longest, {}, left);
         other != below.end() && left(*other) <= right; ++other) {
      const auto& [q, q_to] = *other;
      const double p_side = cross(q_to - q, p - q), p_to_side = cross(q_to - q, p_to - q);
      const double q_side = cross(p_to - p, q - p), q_to_side = cross(p_to - p, q_to - p);
      if ((p_side > 0) == (p_to_side > 0) || (q_side > 0) == (q_to_side > 0)) continue;
      const double p_z = p.z() + p_side / (p_side - p_to_side) * (p_to.z() - p.z());
      const double q_z = q.z() + q_side / (q_side - q_to_side) * (q_to.z() - q.z());
      if (p_z > q_z) sum += q_to_side > q_side ? 1 : -1;
    }
  }
  return sum;
}

// Calls act(n) for each lattice vector n by which the second ring's box comes to overlap the first one's; of a ring and
// itself once for n and −n.
template <class Act>
void for_each_image(const Ring& one, const Ring& two, bool periodic, Act act) {
  const auto least = [&](int d) { return periodic ? std::ceil(one.low[d] - two.high[d]) : 0; };
  const auto most = [&](int d) { return periodic ? std::floor(one.high[d] - two.low[d]) : 0; };
  for (double a = least(0); a <= most(0); ++a)
    for (double b = least(1); b <= most(1); ++b)
      for (double c = least(2); c <= most(2); ++c) {
        const Vec3 n(a, b, c);
        const bool twice = &one == &two && (a < 0 || (a == 0 && (b < 0 || (b == 0 && c <= 0))));
        const bool overlap = ((two.low + n).array() <= one.high.array()).all() &&
                             ((two.high + n).array() >= one.low.array()).all();
        if (overlap && !twice) act(n);
      }
}

}  // namespace

LinkedRings find_linked_rings(const System& sys, const Terms& terms, const State& s) {
  std::vector<Ring> rings;
  for (const auto& atoms : rings_of(sys.atoms(), Adjacency(sys.atoms(), drawn_bonds(sys, terms))))
    if (sys.reach_of(atoms[0]) == Reach::kWhole) rings.push_back(place_ring(atoms, s.box, s.x));
  const Eigen::Matrix3d axes = odd_axes();
  LinkedRings found{.rings = static_cast<int>(rings.size())};
  for (std::size_t i = 0; i < rings.size(); ++i) {
    hear();
    for (std::size_t j = i; j < rings.size(); ++j)
      for_each_image(rings[i], rings[j], s.box.periodic(), [&](const Vec3& n) {
        hear();
        const Vectors image = rings[j].x.colwise() + s.box.lattice_vector(n);
        if (linking_number(axes * rings[i].x, axes * image) == 0) return;
        if (found.pairs++ == 0) found.atom_of_one = rings[i].atom, found.atom_of_other = rings[j].atom;
      });
  }
  return found;
}

std::string linked_rings_message(const System& sys, const Terms& terms, const State& s) {
  if (!terms.nonbonded && !terms.wca && !terms.tabulated_pairs) return "";
  const auto& [rings, pairs, one, other] = find_linked_rings(sys, terms, s);
  if (pairs == 0) return "";
  return fmt::format(
      "{} of the {} rings {} linked, the first those of atoms {} and {}, and stay{} so; to place them "
      "unlinked: "
      "arrange = \"lattice\" in a box with room for each, then run.barostat up to the density",
      pairs == 1 ? "a pair" : fmt::format("{} pairs", pairs), rings, pairs == 1 ? "is" : "are", one, other,
      pairs == 1 ? "s" : "");
}

}  // namespace taut
