#include "constraints/methods/settle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {

Settle::Settle(const System& sys, const Options&, double h)
    : waters_(find_waters(sys)), velocities_(sys, {}, h) {}

std::vector<Settle::Water> Settle::waters_in(const System& sys) {
  const auto bonds_at = bonds_at_atoms(sys.atoms(), sys.bonds);
  const auto other_end = [&](int k, int a) { return sys.bonds[k].i == a ? sys.bonds[k].j : sys.bonds[k].i; };
  const auto bond_between = [&](int a, int b) {
    for (int k : bonds_at[a])
      if (other_end(k, a) == b) return k;
    return -1;
  };
  const auto alike = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(a); };

  std::vector<Water> waters;
  std::vector<char> held(sys.bond_count(), false);
  for (int a = 0; a < sys.atoms(); ++a) {
    if (bonds_at[a].size() != 2) continue;
    const int p = bonds_at[a][0], q = bonds_at[a][1];
    const int left = other_end(p, a), right = other_end(q, a), base = bond_between(left, right);
    if (base < 0 || held[p] || bonds_at[left].size() != 2 || bonds_at[right].size() != 2) continue;
    if (!alike(sys.bonds[p].length, sys.bonds[q].length) || !alike(sys.mass[left], sys.mass[right])) continue;
    if (sys.mass[a] == 0 || sys.mass[left] == 0) continue;
    const double side = sys.bonds[p].length, half = 0.5 * sys.bonds[base].length;
    if (!(side > half)) continue;
    const double height = std::sqrt(side * side - half * half);
    const double ra = 2 * sys.mass[left] * height / (sys.mass[a] + 2 * sys.mass[left]);
    waters.push_back({a, left, right, {p, q, base}, ra, height - ra, half});
    held[p] = held[q] = held[base] = true;
  }
  return waters;
}

Settle::Parts Settle::parts_of(const System& sys) {
  Parts parts;
  std::vector<char> held(sys.bond_count(), false);
  for (const Water& water : waters_in(sys))
    for (const int k : water.bonds) held[k] = true;
  for (int k = 0; k < sys.bond_count(); ++k) (held[k] ? parts.of_waters : parts.rest).push_back(k);
  return parts;
}

std::vector<Settle::Water> Settle::find_waters(const System& sys) {
  if (const Parts parts = parts_of(sys); !parts.rest.empty()) {
    const int k = parts.rest.front();
    throw InputError(
        fmt::format("method settle: bond {} ({}-{}) is not part of a three-site water (a triangle by "
                    "itself, two sides and the masses at their ends equal, none anchored); take newton or "
                    "rattle, or settle with method.solute = \"newton\"",
                    k, sys.bonds[k].i, sys.bonds[k].j));
  }
  return waters_in(sys);
}

// Names follow the paper: 0 is before the step, 1 after the drift, 2 after the rotations φ and ψ, 3 after θ.
// The axes X'Y'Z' have their origin at the drifted centre of mass, Z' along the normal of the old triangle,
// and the drifted apex in the plane Y'Z'. Returns false if no rotation exists because the drifted triangle
// lies too far from the old one.
bool Settle::reset(const Water& w, const System& sys, double h, State& s) const {
  const double ma = sys.mass[w.apex], mh = sys.mass[w.left], inv_total = 1 / (ma + 2 * mh);
  const Vec3 a_new = s.x.col(w.apex), b_new = s.x.col(w.left), c_new = s.x.col(w.right);
  const Vec3 v_a = s.v.col(w.apex);
  const Vec3 b0 = b_new - a_new - h * (s.v.col(w.left) - v_a),
             c0 = c_new - a_new - h * (s.v.col(w.right) - v_a);
  // Positions relative to the apex, so that no large numbers are subtracted.
  const Vec3 centre = mh * inv_total * ((b_new - a_new) + (c_new - a_new));
  const Vec3 a1 = -centre, b1 = b_new - a_new - centre, c1 = c_new - a_new - centre;

  const Vec3 z = b0.cross(c0).normalized(), x = a1.cross(z).normalized(), y = z.cross(x);
  const double xb0 = x.dot(b0), yb0 = y.dot(b0), xc0 = x.dot(c0), yc0 = y.dot(c0);
  const double za1 = z.dot(a1);
  const double xb1 = x.dot(b1), yb1 = y.dot(b1), zb1 = z.dot(b1);
  const double xc1 = x.dot(c1), yc1 = y.dot(c1), zc1 = z.dot(c1);

  const double sin_phi = za1 / w.ra, cos_phi = std::sqrt(1 - sin_phi * sin_phi);
  const double sin_psi = (zb1 - zc1) / (2 * w.rc * cos_phi), cos_psi = std::sqrt(1 - sin_psi * sin_psi);
  const double ya2 = w.ra * cos_phi, xb2 = -w.rc * cos_psi;
  const double yb2 = -w.rb * cos_phi - w.rc * sin_psi * sin_phi,
               yc2 = -w.rb * cos_phi + w.rc * sin_psi * sin_phi;

  const double alpha = xb2 * (xb0 - xc0) + yb0 * yb2 + yc0 * yc2;
  const double beta = xb2 * (yc0 - yb0) + xb0 * yb2 + xc0 * yc2;
  const double gamma = xb0 * yb1 - xb1 * yb0 + xc0 * yc1 - xc1 * yc0;
  const double norm = alpha * alpha + beta * beta;
  const double sin_theta = (alpha * gamma - beta * std::sqrt(norm - gamma * gamma)) / norm;
  const double cos_theta = std::sqrt(1 - sin_theta * sin_theta);
  if (!(std::isfinite(sin_theta) && std::isfinite(cos_theta) && std::isfinite(cos_psi))) return false;

  const Vec3 a3 = -ya2 * sin_theta * x + ya2 * cos_theta * y + za1 * z;
  const Vec3 b3 = (xb2 * cos_theta - yb2 * sin_theta) * x + (xb2 * sin_theta + yb2 * cos_theta) * y + zb1 * z;
  const Vec3 c3 =
      (-xb2 * cos_theta - yc2 * sin_theta) * x + (-xb2 * sin_theta + yc2 * cos_theta) * y + zc1 * z;

  const auto move = [&](int atom, const Vec3& shift) {
    s.x.col(atom) += shift;
    s.v.col(atom) += shift / h;
  };
  move(w.apex, a3 - a1);
  move(w.left, b3 - b1);
  move(w.right, c3 - c1);
  return true;
}

SolveStats Settle::project_positions(const System& sys, double h, State& s) {
  for (const Water& water : waters_)
    if (!reset(water, sys, h, s)) return {1, 0, water.bonds[0], Failure::kShapeLost};
  return {1};
}

std::string Settle::setting() const {
  return fmt::format("{} waters", waters_.size());
}

}  // namespace taut
