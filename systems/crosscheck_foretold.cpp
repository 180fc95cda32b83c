#include "systems/crosscheck_foretold.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"

namespace taut {
namespace {

constexpr long kMostSteps = 200;

// The residual of each bond, a step ahead.
class Residuals {
 public:
  Residuals(const System& sys, const Baumgarte::Options& options, double h)
      : h_(h),
        damping_(damping_named(options.damping)),
        gains_(choose_gains(options.choice(), damping_, sys, h)),
        now_(Eigen::VectorXd::Zero(sys.bond_count())),
        before_(now_),
        projector_(sys) {}

  // Takes σ_n to σ_{n+1}, s being the state at n.
  const Eigen::VectorXd& advance(const System& sys, const State& s) {
    const Eigen::VectorXd& lambda = projector_.multipliers(sys, s);
    Vectors f = s.f;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 along = lambda[k] * (s.x.col(j) - s.x.col(i));
      f.col(i) -= along;
      f.col(j) += along;
    }
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 v = s.v.col(j) - s.v.col(i), a = sys.inv_mass[j] * f.col(j) - sys.inv_mass[i] * f.col(i);
      const double next = residual(k, {v.squaredNorm(), a.squaredNorm(), v.dot(a)});
      before_[k] = now_[k];
      now_[k] = next;
    }
    first_ = false;
    return now_;
  }

 private:
  double residual(int k, const Motion& m) const {
    if (first_) return std::pow(h_, 3) * m.va / 2 + std::pow(h_, 4) * m.a_squared / 8;
    const double ah = gains_[k].alpha * h_, bh = gains_[k].beta * h_;
    const Propagator p(ah, bh, damping_);
    return p.trace * now_[k] - p.determinant * before_[k] +
           (1 - p.trace + p.determinant) * floor_of(ah, bh, h_, m, damping_);
  }

  double h_;
  Damping damping_;
  std::vector<Gains> gains_;
  Eigen::VectorXd now_, before_;  // σ_n, σ_{n−1} [nm²]
  Projector projector_;
  bool first_ = true;
};

}  // namespace

Foretold foretell(const Stage& stage, const Baumgarte::Options& options, const Frames& openmm) {
  const double h = stage.scene.run.h();
  const std::vector<RigidBond>& bonds = stage.scene.system.bonds;
  System sys = stage.scene.system;
  ForceField forces(sys, stage.scene.terms);
  State s = stage.scene.start;
  forces(sys, s);
  Residuals residuals(sys, options, h);
  Foretold foretold;
  double squares = 0;
  std::size_t frame = 0;
  for (long n = 1; n <= std::min(stage.parting, kMostSteps) && frame + 1 < openmm.size(); ++n) {
    const Eigen::VectorXd& sigma = residuals.advance(sys, s);
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double d = bonds[k].length;
      sys.bonds[k].length = std::sqrt(d * d + 2 * sigma[k]);
      squares += std::pow(sys.bonds[k].length / d - 1, 2);
    }
    Newton newton(sys, {.tolerance = 1e-12}, h);  // anew: the lengths are others
    step(sys, forces, newton, h, s);
    if (!stage.samples(n)) continue;
    foretold.apart = most_apart(s.x, openmm[++frame]);
    foretold.steps = n;
    foretold.bond_rms = std::sqrt(squares / static_cast<double>(n * sys.bond_count()));
  }
  return foretold;
}

}  // namespace taut
