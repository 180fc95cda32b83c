#include "md/virtual_sites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/errors.hpp"

namespace taut {
namespace {

using Kind = VirtualSite::Kind;
constexpr double kInLine = 1e-10;  // sine of an angle that is none

// O, X, Y, or the same sums of velocities.
struct Sums {
  Vec3 o = Vec3::Zero(), x = Vec3::Zero(), y = Vec3::Zero();

  Sums(const VirtualSite& site, const Vectors& of) {
    for (const auto& [atom, w, w_x, w_y] : site.parents) {
      o += w * of.col(atom);
      x += w_x * of.col(atom);
      y += w_y * of.col(atom);
    }
  }
};

// The frame turns by ω dt as X and Y change. From de_x = ω × e_x and de_z = ω × e_z:
//     ω·e_z = dX·e_y/|X|,   ω·e_y = −dX·e_z/|X|,   ω·e_x = (|X| dY − (Y·e_x) dX)·e_z/|X × Y|.
struct Frame {
  Vec3 e_x, e_y, e_z;
  double length, area, y_along;  // |X|, |X × Y|, Y·e_x

  Frame(const VirtualSite& site, const Sums& at) : length(at.x.norm()) {
    const Vec3 normal = at.x.cross(at.y);
    area = normal.norm();
    // A site whose parents are nowhere is nowhere, too: which of them it is, is for others to say.
    if (std::isfinite(area) && !(area > kInLine * length * at.y.norm()))
      throw SimulationFailure(fmt::format(
          "atom {}: the parents of its virtual site (the first is atom {}) are in line or in one place, "
          "expected three that span a plane",
          site.atom, site.parents.front().atom));
    e_x = at.x / length;
    e_z = normal / area;
    e_y = e_z.cross(e_x);
    y_along = at.y.dot(e_x);
  }

  Vec3 place(const Vec3& p) const { return p.x() * e_x + p.y() * e_y + p.z() * e_z; }
  Vec3 turning(const Vec3& dx, const Vec3& dy) const {
    return (length * dy - y_along * dx).dot(e_z) / area * e_x - dx.dot(e_z) / length * e_y +
           dx.dot(e_y) / length * e_z;
  }
  // What a torque pulls at X and at Y: the transpose of turning.
  std::pair<Vec3, Vec3> pulls(const Vec3& torque) const {
    const double t_x = torque.dot(e_x) / area, t_y = torque.dot(e_y), t_z = torque.dot(e_z);
    return {t_z / length * e_y - (t_y / length + t_x * y_along) * e_z, t_x * length * e_z};
  }
};

// The site that an atom is; null: it is none.
const VirtualSite* site_at(const VirtualSites& sites, int atom) {
  const auto at = std::ranges::lower_bound(sites, atom, {}, &VirtualSite::atom);
  return at != sites.end() && at->atom == atom ? &*at : nullptr;
}

// Sites have their turns in the order of their atoms. Calls act(site) after it has for those of its parents, and of
// theirs, whose turns are still to come.
template <class Act>
void after_parents(const VirtualSites& sites, const VirtualSite& site, int turn, const Act& act) {
  for (const auto& parent : site.parents)
    if (parent.atom > turn)
      if (const VirtualSite* of = site_at(sites, parent.atom)) after_parents(sites, *of, turn, act);
  act(site);
}

void place(const VirtualSite& site, Vectors& x) {
  const Sums at(site, x);
  x.col(site.atom) = at.o;
  if (site.kind == Kind::kOutOfPlane) x.col(site.atom) += site.p.z() * at.x.cross(at.y);
  if (site.kind == Kind::kLocal) x.col(site.atom) += Frame(site, at).place(site.p);
}

void place_velocity(const VirtualSite& site, const Vectors& x, Vectors& v) {
  const Sums at(site, x), moving(site, v);
  v.col(site.atom) = moving.o;
  if (site.kind == Kind::kOutOfPlane)
    v.col(site.atom) += site.p.z() * (moving.x.cross(at.y) + at.x.cross(moving.y));
  if (site.kind == Kind::kLocal) {
    const Frame frame(site, at);
    v.col(site.atom) += frame.turning(moving.x, moving.y).cross(frame.place(site.p));
  }
}

// What it returns is linear in the force on the site, so that a site may hand on what comes to it in several parts.
Eigen::Matrix3d hand_on(const VirtualSite& site, const Vectors& x, Vectors& f) {
  const Vec3 f_s = f.col(site.atom);
  f.col(site.atom).setZero();
  if (site.kind == Kind::kAverage) {
    for (const auto& parent : site.parents) f.col(parent.atom) += parent.w * f_s;
    return Eigen::Matrix3d::Zero();
  }
  const Sums at(site, x);
  Vec3 p, f_x, f_y;
  if (site.kind == Kind::kOutOfPlane) {
    p = site.p.z() * at.x.cross(at.y);
    f_x = site.p.z() * at.y.cross(f_s);
    f_y = site.p.z() * f_s.cross(at.x);
  } else {
    const Frame frame(site, at);
    p = frame.place(site.p);
    std::tie(f_x, f_y) = frame.pulls(p.cross(f_s));
  }
  for (const auto& [atom, w, w_x, w_y] : site.parents) f.col(atom) += w * f_s + w_x * f_x + w_y * f_y;
  // Σ (x − x_s) fᵀ over the parents
  return at.x * f_x.transpose() + at.y * f_y.transpose() - p * f_s.transpose();
}

// Sites have their turns in the reverse order of their atoms. Hands on again what comes to parents after their turns.
Eigen::Matrix3d hand_down(const VirtualSites& sites, const VirtualSite& site, int turn, const Vectors& x,
                          Vectors& f) {
  Eigen::Matrix3d moved = hand_on(site, x, f);
  for (const auto& parent : site.parents)
    if (parent.atom > turn)
      if (const VirtualSite* of = site_at(sites, parent.atom)) moved += hand_down(sites, *of, turn, x, f);
  return moved;
}

}  // namespace

VirtualSite VirtualSite::average(int atom, std::vector<Parent> parents) {
  return {atom, Kind::kAverage, std::move(parents)};
}

VirtualSite VirtualSite::out_of_plane(int atom, int i, int j, int k, const Vec3& weights) {
  return {atom,
          Kind::kOutOfPlane,
          {{i, 1 - weights[0] - weights[1], -1, -1}, {j, weights[0], 1, 0}, {k, weights[1], 0, 1}},
          Vec3(0, 0, weights[2])};
}

VirtualSite VirtualSite::local(int atom, std::vector<Parent> parents, const Vec3& p) {
  return {atom, Kind::kLocal, std::move(parents), p};
}

std::vector<Weighted> weighted_atoms_of(const VirtualSites& sites, int atom) {
  const VirtualSite* site = site_at(sites, atom);
  if (!site) return {{atom, 1}};
  if (site->kind != Kind::kAverage) return {};
  std::vector<Weighted> all;
  for (const auto& parent : site->parents) {
    if (parent.w == 0) continue;
    const std::vector<Weighted> of_parent = weighted_atoms_of(sites, parent.atom);
    if (of_parent.empty()) return {};
    for (const auto& [a, weight] : of_parent) {
      const auto known = std::ranges::find(all, a, &Weighted::atom);
      if (known == all.end())
        all.push_back({a, parent.w * weight});
      else
        known->weight += parent.w * weight;
    }
  }
  return all;
}

void place_sites(const VirtualSites& sites, Vectors& x) {
  for (const VirtualSite& site : sites)
    after_parents(sites, site, site.atom, [&](const VirtualSite& of) { place(of, x); });
}

void place_site_velocities(const VirtualSites& sites, const Vectors& x, Vectors& v) {
  for (const VirtualSite& site : sites)
    after_parents(sites, site, site.atom, [&](const VirtualSite& of) { place_velocity(of, x, v); });
}

Eigen::Matrix3d hand_to_parents(const VirtualSites& sites, const Vectors& x, Vectors& f) {
  Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
  for (auto site = sites.rbegin(); site != sites.rend(); ++site)
    moved += hand_down(sites, *site, site->atom, x, f);
  return moved;
}

}  // namespace taut
