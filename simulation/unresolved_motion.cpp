#include "simulation/unresolved_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace taut {
namespace {

constexpr double kResolved = 1.5;  // ωh
constexpr double kFollowed = 1;    // Ωh

struct Spring {
  std::vector<int> atoms;
  double stiffness;
  Eigen::VectorXd gradient;  // of its length or angle, three numbers an atom
};

class Springs {
 public:
  Springs(const System& sys, const Box& box, const Vectors& x, bool bonds_are_springs)
      : sys_(sys), box_(box), x_(x) {
    if (bonds_are_springs) return;
    for (const RigidBond& bond : sys.bonds) rigid_.insert(std::minmax(bond.i, bond.j));
  }

  double squared_frequency(const Spring& spring) const {
    const auto n = static_cast<Eigen::Index>(spring.atoms.size());
    std::vector<Eigen::VectorXd> gradients = {spring.gradient};
    for (int a = 0; a < n; ++a)
      for (int b = a + 1; b < n; ++b)
        if (rigid_.contains(std::minmax(spring.atoms[a], spring.atoms[b])))
          gradients.push_back(of_length(spring.atoms, a, b));
    Eigen::VectorXd inv_mass(3 * n);
    for (int a = 0; a < n; ++a) inv_mass.segment<3>(3 * a).setConstant(sys_.inv_mass[spring.atoms[a]]);
    const auto rows = static_cast<Eigen::Index>(gradients.size());
    Eigen::MatrixXd G(rows, rows);
    for (Eigen::Index k = 0; k < rows; ++k)
      for (Eigen::Index l = 0; l < rows; ++l) G(k, l) = gradients[k].cwiseProduct(inv_mass).dot(gradients[l]);
    double free = G(0, 0);
    if (rows > 1) {
      const Eigen::VectorXd held = G.col(0).tail(rows - 1);
      free -= held.dot(G.bottomRightCorner(rows - 1, rows - 1).completeOrthogonalDecomposition().solve(held));
    }
    return spring.stiffness * std::max(0.0, free);
  }

  Spring of(const HarmonicBond& bond) const {
    const std::vector<int> atoms = {bond.i, bond.j};
    return {atoms, bond.k, of_length(atoms, 0, 1)};
  }

  Spring of(const HarmonicAngle& angle) const {
    const Vec3 u = sys_.apart(box_, angle.j, angle.i, x_), w = sys_.apart(box_, angle.j, angle.k, x_);
    const Vec3 e = u.normalized(), f = w.normalized();
    const double cosine = e.dot(f), sine = e.cross(f).norm();
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(9);
    if (sine > 1e-3) {  // in line there is no direction to bend in
      gradient.segment<3>(0) = (cosine * e - f) / (u.norm() * sine);
      gradient.segment<3>(6) = (cosine * f - e) / (w.norm() * sine);
      gradient.segment<3>(3) = -gradient.segment<3>(0) - gradient.segment<3>(6);
    }
    return {{angle.i, angle.j, angle.k}, angle.stiffness, gradient};
  }

 private:
  Eigen::VectorXd of_length(const std::vector<int>& atoms, int a, int b) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(atoms.size()));
    const Vec3 e = sys_.apart(box_, atoms[a], atoms[b], x_).normalized();
    gradient.segment<3>(3 * a) = -e;
    gradient.segment<3>(3 * b) = e;
    return gradient;
  }

  const System& sys_;
  const Box& box_;
  const Vectors& x_;
  std::set<std::pair<int, int>> rigid_;
};

std::string unresolved_spring(const Scene& scene, const Vectors& x, bool bonds_are_springs) {
  const Springs springs(scene.system, scene.start.box, x, bonds_are_springs);
  double fastest = 0;
  Spring which;
  const auto see = [&](const auto& terms) {
    for (const auto& term : terms) {
      Spring spring = springs.of(term);
      const double squared = springs.squared_frequency(spring);
      if (squared > fastest) fastest = squared, which = std::move(spring);
    }
  };
  see(scene.terms.bonds);
  see(scene.terms.angles);
  const double omega_h = std::sqrt(fastest) * scene.run.h();
  if (!(omega_h > kResolved)) return "";
  return fmt::format(
      "run.dt_fs: {:g} fs does not resolve the {} of atoms {}, a spring whose ωh is {:.2g} (above 1.5 "
      "averages are of no use, from 2 on the run fails); take {:.2g} fs or less, where it is 1, or hold it "
      "rigid",
      scene.run.dt_fs, which.atoms.size() == 2 ? "bond" : "angle", fmt::join(which.atoms, "-"), omega_h,
      scene.run.dt_fs / omega_h);
}

std::string unresolved_prescription(const Scene& scene) {
  double fastest = 0;
  std::size_t which = 0;
  for (std::size_t m = 0; m < scene.motions.size(); ++m) {
    const AnchorMotion& motion = scene.motions[m];
    const double rate = std::max(motion.turn.norm(), motion.shake_rate);
    if (rate > fastest) fastest = rate, which = m;
  }
  const double omega_h = fastest * scene.run.h();
  if (!(omega_h > kFollowed)) return "";
  return fmt::format(
      "run.dt_fs: {:g} fs does not resolve motion {}, whose ωh is {:.2g} (above 1 what it pulls with is off "
      "by a "
      "twelfth and more); take {:.2g} fs or less, where it is 0.5",
      scene.run.dt_fs, which, omega_h, 0.5 * scene.run.dt_fs / omega_h);
}

}  // namespace

std::string unresolved_motion(const Scene& scene, const Vectors& x, bool bonds_are_springs) {
  const std::string spring = unresolved_spring(scene, x, bonds_are_springs),
                    prescribed = unresolved_prescription(scene);
  return spring + (spring.empty() || prescribed.empty() ? "" : "; ") + prescribed;
}

}  // namespace taut
