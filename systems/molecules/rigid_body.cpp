#include "systems/molecules/rigid_body.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"

namespace taut {
namespace {

constexpr double kThin = 0.002;  // √(S_d/S₁) below which a body has no extent along axis d

// The centre of mass, and the principal axes of the second moments, largest first.
struct Axes {
  double mass = 0;     // [u]
  Vec3 centre;         // [nm]
  Eigen::Matrix3d e;   // columns
  Vec3 moments;        // S_d [u·nm²]
  int dimensions = 0;  // 1: a line, 2: a plane, 3: a body

  Axes(const Eigen::VectorXd& m, const Vectors& x) : mass(m.sum()), centre(x * m / mass) {
    const Vectors d = x.colwise() - centre;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(d * m.asDiagonal() * d.transpose());
    e = solver.eigenvectors().rowwise().reverse();
    moments = solver.eigenvalues().reverse().cwiseMax(0);
    while (dimensions < 3 && moments[dimensions] > kThin * kThin * moments[0]) ++dimensions;
  }
};

// The point masses, along the principal axes [nm]: one column each.
Eigen::MatrixXd frame_points(const Axes& axes) {
  Eigen::MatrixXd unit(axes.dimensions, axes.dimensions + 1);  // Σ of unit columns t tᵀ is their number
  if (axes.dimensions == 1) unit << 1, -1;
  if (axes.dimensions == 2)
    for (int k = 0; k < 3; ++k) {
      const double phi = 2 * std::numbers::pi * k / 3;
      unit.col(k) = std::numbers::sqrt2 * Eigen::Vector2d(std::cos(phi), std::sin(phi));
    }
  if (axes.dimensions == 3) unit << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  return (axes.moments.head(axes.dimensions) / axes.mass).cwiseSqrt().asDiagonal() * unit;
}

// The weights of the points that put a site at `at`: Σ w = 1, Σ w p = at.
std::vector<double> weights_of(const Eigen::MatrixXd& points, const Eigen::VectorXd& at) {
  Eigen::MatrixXd sums(points.cols(), points.cols());
  sums << Eigen::RowVectorXd::Ones(points.cols()), points;
  Eigen::VectorXd wanted(points.cols());
  wanted << 1, at;
  const Eigen::VectorXd w = sums.partialPivLu().solve(wanted);
  return {w.begin(), w.end()};
}

// The site of atom a at x, of points that are numbered from `first`. Throws InputError for an atom without mass
// beside the line on which all mass lies: nothing says where it turns.
VirtualSite site_of(const Axes& axes, const Eigen::MatrixXd& points, int a, int first, const Vec3& x) {
  const Vec3 at = axes.e.transpose() * (x - axes.centre);
  const auto w = weights_of(points, at.head(axes.dimensions));
  const double thin = 2 * kThin * std::sqrt(axes.moments[0] / axes.mass);
  const bool outside = axes.dimensions < 3 && at.tail(3 - axes.dimensions).norm() > thin;
  if (outside && axes.dimensions == 1)
    throw InputError(fmt::format(
        "atom {} has no mass and is beside the line of those that have: give it mass, or put it on the line",
        a));
  if (outside) {  // of the plane: r₀₁ × r₀₂ is along ±e₃
    const Eigen::Vector2d r1 = points.col(1) - points.col(0), r2 = points.col(2) - points.col(0);
    const double turned = axes.e.determinant() * (r1.x() * r2.y() - r1.y() * r2.x());
    return VirtualSite::out_of_plane(a, first, first + 1, first + 2, {w[1], w[2], at.z() / turned});
  }
  std::vector<VirtualSite::Parent> parents;
  for (const double weight : w) parents.push_back({first + static_cast<int>(parents.size()), weight});
  return VirtualSite::average(a, std::move(parents));
}

void lengthen(Eigen::VectorXd& values, Eigen::Index by, double value) {
  const Eigen::Index n = values.size();
  values.conservativeResize(n + by);
  values.tail(by).setConstant(value);
}

void exclude_all_pairs(Nonbonded& pairs, int atoms) {
  const auto acts = [&](int a) { return pairs.charge[a] != 0 || pairs.epsilon[a] != 0; };
  pairs.exceptions.clear();
  for (int i = 0; i < atoms; ++i)
    for (int j = i + 1; j < atoms; ++j)
      if (acts(i) && acts(j)) pairs.exceptions.push_back({i, j, 0, (pairs.sigma[i] + pairs.sigma[j]) / 2, 0});
}

}  // namespace

VirtualSites read_sites(RowReader& rows, const Eigen::VectorXd& mass) {
  VirtualSites sites;
  std::vector<bool> is_site(static_cast<std::size_t>(mass.size()));
  const auto add = [&](const char* key, const Row& row, VirtualSite site) {
    if (mass[site.atom] != 0)
      rows.fail(
          key, row,
          fmt::format("atom {} is a virtual site of mass {:g} u, expected mass_u = 0: its parents carry "
                      "the mass",
                      site.atom, mass[site.atom]));
    if (is_site[static_cast<std::size_t>(site.atom)])
      rows.fail(key, row, fmt::format("atom {} is a virtual site already", site.atom));
    is_site[static_cast<std::size_t>(site.atom)] = true;
    sites.push_back(std::move(site));
  };
  const char* two = "virtual sites [s, i, j, a], of mass 0: atom s is at (1 − a) x_i + a x_j";
  for (const Row& row : rows.read("virtual_sites2", 3, 1, two)) {
    const auto& [s, i, j, k] = row.atom;
    const double a = row.number[0];
    add("virtual_sites2", row, VirtualSite::average(s, {{i, 1 - a}, {j, a}}));
  }
  const char* three =
      "virtual sites [s, i, j, k, a, b], of mass 0: atom s is at (1 − a − b) x_i + a x_j + b x_k";
  for (const Row& row : rows.read("virtual_sites3", 4, 2, three)) {
    const auto& [s, i, j, k] = row.atom;
    const double a = row.number[0], b = row.number[1];
    add("virtual_sites3", row, VirtualSite::average(s, {{i, 1 - a - b}, {j, a}, {k, b}}));
  }
  const char* out =
      "virtual sites [s, i, j, k, a, b, c in 1/nm], of mass 0: atom s is at x_i + a r_ij + b r_ik + c r_ij × "
      "r_ik";
  for (const Row& row : rows.read("virtual_sites3out", 4, 3, out)) {
    const auto& [s, i, j, k] = row.atom;
    add("virtual_sites3out", row, VirtualSite::out_of_plane(s, i, j, k, Vec3(row.number)));
  }
  return sites;
}

void make_rigid(Molecule& molecule) {
  const int atoms = molecule.atoms();
  if (!(molecule.system.mass.sum() > 0)) throw InputError("a rigid molecule needs atoms with mass");
  const Axes axes(molecule.system.mass, molecule.x);
  if (axes.dimensions == 0) throw InputError("all mass of the rigid molecule is at one point");
  const Eigen::MatrixXd points = frame_points(axes);
  const int frame = static_cast<int>(points.cols());
  const auto e = axes.e.leftCols(axes.dimensions);

  VirtualSites sites;
  for (int a = 0; a < atoms; ++a) sites.push_back(site_of(axes, points, a, atoms, molecule.x.col(a)));
  molecule.x.conservativeResize(3, atoms + frame);
  molecule.x.rightCols(frame) = (e * points).colwise() + axes.centre;
  place_sites(sites, molecule.x);

  std::vector<RigidBond> bonds;
  for (int i = 0; i < frame; ++i)
    for (int j = i + 1; j < frame; ++j)
      bonds.push_back({atoms + i, atoms + j, (points.col(j) - points.col(i)).norm()});
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(atoms + frame);
  mass.tail(frame).setConstant(axes.mass / frame);
  molecule.system = make_system(std::move(mass), std::move(bonds), std::move(sites));
  const std::string residue = molecule.kinds.front().residue;
  molecule.kinds.insert(molecule.kinds.end(), static_cast<std::size_t>(frame), {kFrameAtom, residue, ""});
  if (auto& pairs = molecule.terms.nonbonded) {
    exclude_all_pairs(*pairs, atoms);
    lengthen(pairs->charge, frame, 0);
    lengthen(pairs->sigma, frame, 1);
    lengthen(pairs->epsilon, frame, 0);
  }
}

}  // namespace taut
