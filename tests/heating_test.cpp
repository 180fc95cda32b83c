// What constraints do to the energy: the account's identity for every method, and why a bond that follows its
// neighbours' vibrations heats them.

#include <gtest/gtest.h>

#include <cmath>

#include "base/statistics.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "ensembles/langevin.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut::heating_tests {
namespace {

// Every atom on a spring to the origin.
struct Trap : ForceLaw {
  void evaluate(const System&, State& s) override { s.f = -kStiffness * s.x; }
  static constexpr double kStiffness = 2;
};

double squares_over_mass(const System& sys, const Vectors& f) {
  return (f.array().square().rowwise() * sys.inv_mass.transpose().array()).sum();
}

// Of methods that steer by forces, C = Jᵀλ: the work is Σ ½(λ_n + λ_{n+1})Δσ + ¼(λ_{n+1} − λ_n)|Δr|².
TEST(Account, IsWhatMultipliersDo) {
  const double h = 0.004;
  for (const char* name : {"none", "baumgarte", "feedforward"}) {
    SCOPED_TRACE(name);
    auto [sys, s] = tests::free_chain(6, 1);
    const auto method = make_method(sys, default_options(name), h);
    Trap trap;
    VelocityVerlet verlet;
    const Dynamics dynamics{sys, trap, *method};
    initialize(verlet, dynamics, h, s);
    const auto kept = [&, &system = sys, &state = s] {
      return kinetic_energy(system, state.v) - h * h / 8 * squares_over_mass(system, state.f) -
             verlet.account.work;
    };
    const double at_start = kept(), scale = kinetic_energy(sys, s.v);
    double work = 0;
    Vectors r(3, sys.bond_count()), r_next = r;
    for (int n = 0; n < 200; ++n) {
      const Eigen::VectorXd lambda = method->lambda();
      differences(sys, s.x, r);
      ASSERT_TRUE(verlet.advance(dynamics, h, s).converged());
      differences(sys, s.x, r_next);
      const Eigen::VectorXd& next = method->lambda();
      for (int k = 0; k < sys.bond_count(); ++k)
        work += 0.25 * (lambda[k] + next[k]) * (r_next.col(k).squaredNorm() - r.col(k).squaredNorm()) +
                0.25 * (next[k] - lambda[k]) * (r_next.col(k) - r.col(k)).squaredNorm();
    }
    EXPECT_NEAR(kept() - at_start, work, 1e-11 * scale);
  }
}

// The change of the kinetic energy less the forces' work, beside what the motion shows of the constraints' forces:
// C = 2M(first − v_n)/h − F_n before the middle of the drift, C' = 2M(v_{n+1} − second)/h − F_{n+1} after it. Without a
// thermostat `first` and `second` are both the velocity of the drift. Langevin's changes it in the middle by Δ: this jump
// does a work on the velocities, and what is left of the forces' kicks is the constraints' alone. The bath's heat is what
// the jump's two halves do to the kinetic energy of the motion that is tangent to the bonds where each half acts: the
// first where the drift begins, the second where it ends.
TEST(Account, ClosesForEveryMethodAloneAndInABath) {
  const double h = 0.004;
  for (const MethodEntry& entry : methods())
    for (const bool in_bath : {false, true}) {
      SCOPED_TRACE(std::string(entry.name) + (in_bath ? " in a bath" : ""));
      auto [sys, s] = entry.name == "settle" ? tests::waters(2, 1, 300) : tests::free_chain(6, 1);
      const auto method = make_method(sys, default_options(entry.name), h);
      Langevin langevin(sys, {.temperature = 1 / kBoltzmann, .friction = 10}, h);
      Trap trap;
      VelocityVerlet verlet;
      Integrator& integrator = in_bath ? static_cast<Integrator&>(langevin) : verlet;
      const Dynamics dynamics{sys, trap, *method};
      initialize(integrator, dynamics, h, s);
      const auto unaccounted = [&, &start = s, &system = sys] {
        return kinetic_energy(system, start.v) - integrator.account.work;
      };
      const double at_start = unaccounted(), scale = kinetic_energy(sys, s.v);
      Projector projector(sys);
      double work = 0, jump = 0, heat = 0, largest = 0;
      for (int n = 0; n < 200; ++n) {
        const State before = s;
        const Vectors half_jump = in_bath ? langevin.half_jump() : Vectors::Zero(3, sys.atoms());
        ASSERT_TRUE(integrator.advance(dynamics, h, s).converged());
        const Vectors half = (s.x - before.x) / h, first = half - half_jump, second = half + half_jump;
        jump += kinetic_energy(sys, second) - kinetic_energy(sys, first);
        const Vectors f = 2 / h * (first - before.v) * sys.mass.asDiagonal();   // F + C
        const Vectors f_next = 2 / h * (s.v - second) * sys.mass.asDiagonal();  // F + C'
        work += 0.5 * h * (f + Trap::kStiffness * before.x).cwiseProduct(first).sum() +
                0.5 * h * (f_next + Trap::kStiffness * s.x).cwiseProduct(second).sum() +
                h * h / 8 * (squares_over_mass(sys, f_next) - squares_over_mass(sys, f));
        ASSERT_NEAR(unaccounted() - at_start, work + jump, (in_bath ? 1e-10 : 1e-11) * scale) << "step " << n;
        if (!in_bath) continue;
        Vectors tangent = second, jump_there = half_jump;
        projector.velocities(sys, s.x, tangent);
        projector.velocities(sys, s.x, jump_there);
        heat += kinetic_energy(sys, half) - kinetic_energy(sys, first) + kinetic_energy(sys, tangent) -
                kinetic_energy(sys, tangent - jump_there);
        largest = std::max(largest, std::abs(heat));
        ASSERT_NEAR(integrator.account.heat, heat, 1e-10 * scale) << "step " << n;
      }
      if (in_bath) {
        EXPECT_GT(largest, 0.1 * scale);
      }
    }
}

// kT = 1, unit masses, free of forces. What is left of the energy's change when the heat is taken off, per
// cluster and unit of time: with the heat as if all of Δ were tangent, and with what turning makes of it.
struct LeftOfTheEnergy {
  double if_all_were_tangent, really, largest;
};

LeftOfTheEnergy left_in_a_bath(tests::Start start, int clusters, double temperature, double friction,
                               double h, int steps) {
  auto& [sys, s] = start;
  Newton method(sys, {.tolerance = 1e-13}, h);
  Langevin bath(sys, {.temperature = temperature, .friction = friction, .seed = 5}, h);
  tests::NoForce forces;
  const Dynamics dynamics{sys, forces, method};
  initialize(bath, dynamics, h, s);
  Projector projector(sys);
  const double at_start = kinetic_energy(sys, s.v);
  double turning = 0, largest = 0;
  for (int n = 0; n < steps; ++n) {
    const Vectors x = s.x, half_jump = bath.half_jump();
    EXPECT_TRUE(bath.advance(dynamics, h, s).converged());
    Vectors turned = half_jump;
    projector.velocities(sys, s.x, turned);
    const Vectors turns = turned - half_jump, second = (s.x - x) / h + 0.5 * half_jump;
    turning += (second * sys.mass.asDiagonal()).cwiseProduct(turns).sum();
    largest = std::max(largest, std::abs(kinetic_energy(sys, s.v) - at_start - bath.account.heat));
  }
  const double each = clusters * steps * h, change = kinetic_energy(sys, s.v) - at_start;
  return {(change - bath.account.heat + turning) / each, (change - bath.account.heat) / each, largest};
}

// Dumbbells lose ½γh²(kT)²/(μd²) a unit of time to the turning, and nothing else: what is left is rounding.
TEST(Account, OfDumbbellsInABathIsTheBathsAlone) {
  constexpr int kDumbbells = 50;
  const double h = 0.1, friction = 0.5, mu = 0.5, d = 1;
  tests::Start start;
  std::vector<RigidBond> bonds;
  Random random(3);
  start.state.x = start.state.v = start.state.f = Vectors::Zero(3, 2 * kDumbbells);
  for (int k = 0; k < kDumbbells; ++k) {
    bonds.push_back({2 * k, 2 * k + 1, d});
    start.state.x.col(2 * k + 1) = d * random.unit_vector();
  }
  for (int a = 0; a < 2 * kDumbbells; ++a) start.state.v.col(a) = random.normal_vector();
  start.system = make_system(Eigen::VectorXd::Ones(2 * kDumbbells), bonds);
  const LeftOfTheEnergy left =
      left_in_a_bath(std::move(start), kDumbbells, 1 / kBoltzmann, friction, h, 20000);
  EXPECT_NEAR(left.if_all_were_tangent / (-0.5 * friction * h * h / (mu * d * d)), 1, 0.08);
  EXPECT_LT(left.largest, 1e-8);
}

// So it is with waters, which turn about three axes: RATTLE keeps the energy of a free rigid body exactly.
TEST(Account, OfFreeWatersInABathIsTheBathsAlone) {
  const LeftOfTheEnergy left = left_in_a_bath(tests::waters(50, 5, 300), 50, 300, 20, 2e-3, 5000);
  EXPECT_LT(left.if_all_were_tangent, -0.02);
  EXPECT_LT(std::abs(left.really), 1e-8);
}

// A rigid bond on a wall, held to a direction by a spring: U = ½kφ². Small swings have the frequency ω with
// 2 − 2cos ωh = kh²/(md²), in steps of length h.
struct Swing : ForceLaw {
  Swing(double omega_h, double h) : stiffness((2 - 2 * std::cos(omega_h)) / (h * h)) {}
  void evaluate(const System&, State& s) override {
    const double x = s.x(0, 1), y = s.x(1, 1);
    angle = std::atan2(y, x);
    s.f.setZero();
    s.f.col(1) = -stiffness * angle / (x * x + y * y) * Vec3(-y, x, 0);
  }
  double potential() const { return 0.5 * stiffness * angle * angle; }
  double stiffness, angle = 0;
};

struct Shares {
  double bonds, forces;  // of the energy's change a step
};

// The same, tied to a place at the bond's rest by a spring that is not across it.
struct Tether : ForceLaw {
  Tether(double omega_h, double h) : stiffness((2 - 2 * std::cos(omega_h)) / (h * h)) {}
  void evaluate(const System&, State& s) override {
    const Vec3 off = s.x.col(1) - Vec3::UnitX();
    s.f.setZero();
    s.f.col(1) = -stiffness * off;
    energy = 0.5 * stiffness * off.squaredNorm();
  }
  double potential() const { return energy; }
  double stiffness, energy = 0;
};

template <class Force>
Shares shares_of(double omega_h, double amplitude, const Baumgarte::Options& options, double h) {
  const System sys = make_system(Eigen::Vector2d(0, 1), {{0, 1, 1.0}});
  State s;
  s.x = s.v = s.f = Vectors::Zero(3, 2);
  s.x.col(1) = Vec3(std::cos(amplitude), std::sin(amplitude), 0);
  Force force(omega_h, h);
  Baumgarte method(sys, options, h);
  const Dynamics dynamics{sys, force, method};
  VelocityVerlet verlet;
  initialize(verlet, dynamics, h, s);
  Slope bonds, forces;
  for (int n = 0; n < 4000; ++n) {
    EXPECT_TRUE(verlet.advance(dynamics, h, s).converged());
    if (n < 500) continue;
    bonds.add(n, kinetic_energy(sys, s.v) - h * h / 8 * s.f.squaredNorm() - verlet.account.work);
    forces.add(n, force.potential() + verlet.account.work);
  }
  return {bonds.value(), forces.value()};
}

Baumgarte::Options gains(double ah, double bh_squared, const char* damping, double h) {
  return {.gains = "numbers",
          .damping = damping,
          .alpha_per_ps = ah / h,
          .beta_per_ps = std::sqrt(bh_squared) / h};
}

// What a step of the centred law pumps into a swing of amplitude A (constraints/README.md): with ϑ = 2ωh,
//     8 (md²/h²) A⁴ αh sin⁶(ωh/2) sin(ωh) sin ϑ / |D|²,   |D|² = (2cos ϑ − 2 + (βh)²)² + (2αh sin ϑ)².
double pumped(double omega_h, double amplitude, double ah, double bh_squared, double h) {
  const double theta = 2 * omega_h, s = std::sin(omega_h / 2);
  const double d2 = std::pow(2 * std::cos(theta) - 2 + bh_squared, 2) + std::pow(2 * ah * std::sin(theta), 2);
  return 8 / (h * h) * std::pow(amplitude, 4) * ah * std::pow(s, 6) * std::sin(omega_h) * std::sin(theta) /
         d2;
}

// The forces take sin² of it back: a spring at an arm that changes its length.
TEST(Heating, ABondPumpsASwing) {
  const double h = 0.002, amplitude = 0.02;
  for (const double omega_h : {0.3, 0.565, 0.7})
    for (const auto& [ah, bh2] : {std::pair{0.1, 2.0}, {0.1, 3.0}, {0.5, 2.0}, {1.0, 2.5}}) {
      const Shares shares = shares_of<Swing>(omega_h, amplitude, gains(ah, bh2, "centred", h), h);
      const double foretold = pumped(omega_h, amplitude, ah, bh2, h);
      EXPECT_NEAR(shares.bonds / foretold, 1, 0.05) << omega_h << " " << ah << " " << bh2;
      EXPECT_NEAR(shares.forces / foretold, -2 * std::pow(std::sin(omega_h / 2), 2), 0.05) << omega_h;
    }
}

// Along the bond a force changes with the bond's error, and the pumping with it. A linear force's work is
// what its energy loses, in every step, so that it takes nothing back.
TEST(Heating, ABondTiedToAPlaceIsPumpedMore) {
  const double h = 0.002, amplitude = 0.02;
  for (const double omega_h : {0.3, 0.565, 0.7})
    for (const auto& [ah, bh2] : {std::pair{0.1, 2.0}, {0.1, 3.0}, {0.5, 2.0}}) {
      const Shares shares = shares_of<Tether>(omega_h, amplitude, gains(ah, bh2, "centred", h), h);
      const double across = pumped(omega_h, amplitude, ah, bh2, h);
      EXPECT_GT(shares.bonds / across, 1.25) << omega_h << " " << ah << " " << bh2;
      EXPECT_LT(shares.bonds / across, 1.48) << omega_h << " " << ah << " " << bh2;
      EXPECT_NEAR(shares.forces / across, 0, 0.005) << omega_h;
    }
}

// Where σ̈ is the step's own difference, nothing drives σ, and nothing is pumped.
TEST(Heating, TheDiscreteLawPumpsNothing) {
  const double h = 0.002, amplitude = 0.02;
  for (const double omega_h : {0.3, 0.565, 0.7}) {
    const double centred = pumped(omega_h, amplitude, 0.3, 2.5, h);
    const Shares discrete = shares_of<Swing>(omega_h, amplitude, gains(0.3, 2.5, "discrete", h), h);
    EXPECT_LT(std::abs(discrete.bonds), 0.01 * centred) << omega_h;
  }
}

// The two edges. The filter's pole, 2cos 2ωh = 2 − (βh)², is where weak damping pumps most; and weak damping
// cannot hold the parasitic root at 120°, (βh)² = 3, where quadratic terms turn in step with it.
TEST(Heating, IsWorstAtTheFiltersPole) {
  const double h = 0.002, amplitude = 0.005;
  const auto bonds = [&](double bh2) {
    return shares_of<Swing>(0.565, amplitude, gains(0.05, bh2, "centred", h), h).bonds;
  };
  const double pole = 2 - 2 * std::cos(2 * 0.565);
  EXPECT_GT(bonds(pole), 5 * bonds(0.8 * pole));
  EXPECT_GT(bonds(pole), 5 * bonds(1.2 * pole));
}

}  // namespace
}  // namespace taut::heating_tests
