#include "studies/crosscheck_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"

namespace taut {
namespace {

constexpr double kNudge = 1e-10;     // [nm]
constexpr double kSaturated = 0.01;  // apart by more, chaos has done its work [nm]
constexpr long kShort = 200;         // steps of runs that settle one question

double at_float(double length) {
  return static_cast<double>(static_cast<float>(length));
}

// The lengths OpenMM holds, told from its positions: ours, or the floats nearest to ours.
std::vector<RigidBond> lengths_held(const System& sys, const Vectors& x, int& rounded) {
  std::vector<RigidBond> bonds = sys.bonds;
  for (auto& [i, j, length] : bonds) {
    const double now = (x.col(j) - x.col(i)).norm(), nearest = at_float(length);
    if (std::abs(now - nearest) > 1e-10 * length || std::abs(nearest - length) < 1e-9 * length) continue;
    length = nearest;
    ++rounded;
  }
  return bonds;
}

// newton and the twin, both from a scene's start.
double apart_after(const Stage& stage, const Scene& scene, long steps) {
  Simulation simulation(scene);
  const auto twin = stage.twin({});
  twin->set(simulation.state());
  simulation.run({}, at_steps(stage.plan.listen));
  advance(*twin, steps, stage.plan.listen);
  return most_apart(simulation.state().x, twin->state().x);
}

}  // namespace

StartDifference compare_start(const Stage& stage, OpenMMTwin& twin) {
  ForceField forces(stage.scene.system, stage.scene.start.box, stage.scene.terms);
  State s = stage.scene.start;
  ForceField::Evaluation besides;
  forces.evaluate(stage.scene.system, s, besides);
  Vectors theirs;
  const double energy = twin.forces_at(s.x, theirs);
  Vectors difference = s.f - theirs;
  for (int a = 0; a < stage.scene.system.atoms(); ++a)
    if (stage.scene.system.mass[a] == 0) difference.col(a).setZero();  // no force moves an anchor
  return {
      .energy = forces.potential(s, besides),
      .openmm_energy = energy,
      .force_rms = std::sqrt(s.f.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, s.f.size()))),
      .force_difference = difference.cwiseAbs().maxCoeff(),
      .terms = forces.energies(s, besides)};
}

OpenMMBonds openmm_bonds(const Stage& stage, double worst_seen) {
  OpenMMBonds result{.worst = worst_seen};
  if (stage.scene.system.bonds.empty()) return result;
  const auto twin = stage.twin({});
  twin->step(1);
  Scene scene = stage.scene;
  const std::vector<RigidBond> held = lengths_held(scene.system, twin->state().x, result.rounded);
  if (result.rounded == 0) return result;
  result.steps = scene.run.steps = std::min(stage.parting, kShort);
  scene.run.log_every = result.steps;
  result.apart_as_given = apart_after(stage, scene, result.steps);
  scene.system.bonds = held;
  result.apart_with_theirs = apart_after(stage, scene, result.steps);
  return result;
}

static State nudged(const Scene& scene) {
  Random random(scene.run.seed);
  State s = scene.start;
  for (int a = 0; a < scene.system.atoms(); ++a)
    if (scene.system.mass[a] > 0) s.x.col(a) += kNudge * random.unit_vector();
  return s;
}

Track nudged_run(const Stage& stage, const Contestant& contestant, const Against& against) {
  Stage moved = stage;
  moved.scene.start = nudged(stage.scene);
  return follow(moved, {contestant.name + " moved 1e-10", contestant.method}, stage.parting, against).track;
}

Track nudged_run(const Stage& stage, const Against& against) {
  const auto twin = stage.twin(stage.on_platform());
  twin->set(nudged(stage.scene));
  return follow(stage, "openmm moved 1e-10", *twin, stage.parting, against).track;
}

Chaos chaos_of(const Track& nudged) {
  Chaos chaos;
  Slope rate;
  for (const Sample& s : nudged.samples) {
    if (s.apart > kSaturated) break;
    chaos.growth = std::max(chaos.growth, s.apart / kNudge);
    chaos.steps = s.step;
  }
  for (const Sample& s : nudged.samples)
    if (s.apart > 0 && 2 * s.step >= chaos.steps && s.step <= chaos.steps) rate.add(s.t, std::log(s.apart));
  chaos.rate = {rate.value(), rate.standard_error()};
  return chaos;
}

Leapfrog compare_leapfrog(const Stage& stage) {
  Leapfrog found{.steps = std::min(stage.parting, 20L)};
  const auto twin = stage.twin({}), verlet = stage.twin({.integrator = TwinIntegrator::kVerlet});
  advance(*twin, found.steps, stage.plan.listen);
  advance(*verlet, found.steps, stage.plan.listen);
  const State ours = twin->state(), theirs = verlet->state();
  found.positions = most_apart(ours.x, theirs.x);
  found.velocities = most_apart(ours.v, theirs.v);
  found.velocities_kept = most_apart(ours.v, verlet->kept_velocities());
  return found;
}

namespace {

constexpr long kMostSteps = 200;

// The residual of each bond, a step ahead.
class Residuals {
 public:
  Residuals(const System& sys, const Baumgarte::Options& options, double h)
      : h_(h),
        passes_(options.passes),
        damping_(damping_named(options.damping)),
        gains_(choose_gains(options.choice(), damping_, sys, h)),
        guesses_(guesses_of(sys, damping_)),
        now_(Eigen::VectorXd::Zero(sys.bond_count())),
        before_(now_),
        next_(now_),
        past_{now_, now_, now_},
        r_(3, sys.bond_count()),
        projector_(sys),
        solver_(sys) {}

  // Takes σ_n to σ_{n+1}, s being the state at n.
  const Eigen::VectorXd& advance(const System& sys, const State& s) {
    const Eigen::VectorXd exact = projector_.multipliers(sys, s);
    differences(sys, s.x, r_);
    const Vectors a = s.f * sys.inv_mass.asDiagonal() + pulled(sys, exact);
    for (int k = 0; k < sys.bond_count(); ++k) next_[k] = residual(k, motion(sys.bonds[k], s.v, a));
    add_miss(sys, s.v, a, exact);
    before_ = now_;
    now_ = next_;
    ++steps_;
    return now_;
  }

 private:
  static Motion motion(const RigidBond& bond, const Vectors& v, const Vectors& a) {
    const Vec3 v_ij = v.col(bond.j) - v.col(bond.i), a_ij = a.col(bond.j) - a.col(bond.i);
    return {v_ij.squaredNorm(), a_ij.squaredNorm(), v_ij.dot(a_ij)};
  }

  Vectors pulled(const System& sys, const Eigen::VectorXd& lambda) const {  // M⁻¹Jᵀλ
    Vectors a = Vectors::Zero(3, sys.atoms());
    add_constraint_acceleration(sys, r_, lambda, a);
    return a;
  }

  double residual(int k, const Motion& m) const {
    if (steps_ == 0) return std::pow(h_, 3) * m.va / 2 + std::pow(h_, 4) * m.a_squared / 8;
    const double ah = gains_[k].alpha * h_, bh = gains_[k].beta * h_;
    const Propagator p(ah, bh, damping_);
    return p.trace * now_[k] - p.determinant * before_[k] +
           (1 - p.trace + p.determinant) * floor_of(ah, bh, h_, m, damping_);
  }

  // With one pass |v_ij|² is taken with a guess λ*, which misses λ and so adds −h³ v_ij·y_ij,
  // y = M⁻¹Jᵀ(λ* − λ), to σ_{n+1}: nothing for a bond alone, whose v_ij is across it, but as much as the
  // floor where bonds meet. The discrete law takes |a_ij|² so, too, and adds −½h⁴ (a_ij + y_ij)·y_ij.
  void add_miss(const System& sys, const Vectors& v, const Vectors& a, const Eigen::VectorXd& exact) {
    const bool discrete = damping_ == Damping::kDiscrete;
    const auto of = [&](const Vectors& of_atoms, int k) -> Vec3 {
      return of_atoms.col(sys.bonds[k].j) - of_atoms.col(sys.bonds[k].i);
    };
    Eigen::VectorXd lambda(sys.bond_count());  // what the law adds: A⁻¹(−2ασ̇ − β²σ), discrete −¼h²|a|² too
    for (int k = 0; k < sys.bond_count(); ++k)
      lambda[k] = -gains_[k].alpha / h_ * (next_[k] - before_[k]) - std::pow(gains_[k].beta, 2) * now_[k] -
                  (discrete ? 0.25 * h_ * h_ * of(a, k).squaredNorm() : 0);
    solver_.factor(r_);
    solver_.solve(lambda);
    if (steps_ == 0) lambda.setZero();
    lambda += exact;
    if (steps_ > 0 && passes_ == 1) {
      const Vectors missed = pulled(sys, guessed() - lambda);
      for (int k = 0; k < sys.bond_count(); ++k) {
        const double share = damping_ == Damping::kImplicit ? 1 / (1 + gains_[k].alpha * h_) : 1.0;
        const Vec3 y = of(missed, k);
        next_[k] -= share * std::pow(h_, 3) * of(v, k).dot(y);
        if (discrete) next_[k] -= 0.5 * std::pow(h_, 4) * (of(a, k) + y).dot(y);
      }
    }
    past_ = {lambda, past_[0], past_[1]};
  }

  Eigen::VectorXd guessed() const {  // λ*
    Eigen::VectorXd guess(past_[0].size());
    for (int k = 0; k < guess.size(); ++k) {
      const auto [first, second] = limit_to_known(guesses_[k], static_cast<int>(std::min(steps_, 3L)));
      guess[k] = past_[0][k] + first * (past_[0][k] - past_[1][k]) + second * (past_[1][k] - past_[2][k]);
    }
    return guess;
  }

  double h_;
  int passes_;
  Damping damping_;
  std::vector<Gains> gains_;
  std::vector<Guess> guesses_;
  Eigen::VectorXd now_, before_, next_;  // σ_n, σ_{n−1}, σ_{n+1} [nm²]
  std::array<Eigen::VectorXd, 3> past_;  // λ of the steps before
  Vectors r_;                            // 3 × m
  Projector projector_;
  DirectSolver solver_;
  long steps_ = 0;
};

}  // namespace

Foretold foretell(const Stage& stage, const Baumgarte::Options& options, const Frames& openmm) {
  const double h = stage.scene.run.h();
  const std::vector<RigidBond>& bonds = stage.scene.system.bonds;
  System sys = stage.scene.system;
  ForceField forces(sys, stage.scene.start.box, stage.scene.terms);
  State s = stage.scene.start;
  forces.evaluate(sys, s);
  Residuals residuals(sys, options, h);
  Foretold foretold;
  double squares = 0;
  std::size_t frame = 0;
  for (long n = 1; n <= std::min(stage.parting, kMostSteps) && frame + 1 < openmm.size(); ++n) {
    if (stage.plan.listen) stage.plan.listen();
    const Eigen::VectorXd& sigma = residuals.advance(sys, s);
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double d = bonds[k].length;
      sys.bonds[k].length = std::sqrt(d * d + 2 * sigma[k]);
      squares += std::pow(sys.bonds[k].length / d - 1, 2);
    }
    Newton newton(sys, {.tolerance = 1e-12}, h);  // anew: the lengths are others
    demand_converged(sys, s, step({sys, forces, newton}, h, s), n);
    if (!stage.samples(n)) continue;
    foretold.apart = most_apart(s.x, openmm[++frame]);
    foretold.steps = n;
    foretold.bond_rms = std::sqrt(squares / static_cast<double>(n * sys.bond_count()));
  }
  return foretold;
}

}  // namespace taut
