#pragma once

#include <cstdint>

#include "base/aligned.hpp"
#include "base/course.hpp"
#include "base/random.hpp"
#include "ensembles/drift_velocity.hpp"
#include "md/integrator.hpp"

namespace taut {

// Langevin dynamics, the thermostat in the middle of the drift of velocity Verlet, whose symbols and stages it shares
// (md/velocity_verlet.hpp; BAOAB: Leimkuhler and Matthews 2013, doi:10.1063/1.4802990; under constraints: the same
// 2016, doi:10.1098/rspa.2016.0138; the middle scheme: Zhang et al. 2019, doi:10.1021/acs.jpca.9b02771),
//     kick h/2 · drift h/2 · v ← v + Δ · drift h/2 · kick h/2,
//     Δ = P (cv + √(1−c²) √(kT/m) R − v),   c = exp(−γh),   R normal numbers,
// P the projection on the tangent space of the bonds where the drift begins (ensembles/drift_velocity.hpp). There √(kT/m)
// PR has the canonical distribution, so Δ leaves it as it is. Both half drifts together are one with the velocity
// v½ + ½Δ: one position solve a step serves.
//
// Who steers σ by forces must know Δ before λ is found. It can: a constraint force has no tangent part, so Δ
// follows from v½ + hM⁻¹F without it, and is drawn one step ahead. Between its two drifts the velocity
// then changes by h(a + (½Δ_old + ½Δ)/h): to `add_forces` the noise is one more force, M(½Δ_old + ½Δ)/h
// (Push::noise), and every identity of constraints/README.md holds with that acceleration. Cost: 3n normal
// numbers (ensembles/noise.hpp), and twice a factorization and solve for P, the second time for the heat. On
// threads it draws the same bits.
//
// Heat. Δ is tangent where the drift begins. When the drift ends the bonds have turned, and of the second
// half a = ½Δ the constraints take out at once what is not tangent there, (1 − P')a. So the bath gives
//     Σ m(v½ + ½a)·a  +  Σ m(v½ + (3/2)a)·P'a,
// v½ being the velocity before Δ. With a in place of P'a the bonds would seem to take energy, whoever
// holds them: dumbbells of reduced mass μ and length d ½γh²(kT)²/(μd²) each in a unit of time.
class Langevin final : public Integrator {
 public:
  struct Settings {
    double temperature;          // [K]
    double friction;             // γ [1/ps]
    std::uint64_t seed = 1;      // of R
    bool hold_momentum = false;  // Δ without total momentum; for systems where no bond is anchored
    // Bonds are springs: there is no tangent space, and their force changes the velocity that friction acts
    // on, so that Δ has to know it, where it need not know Jᵀλ.
    ConstraintMethod* springs = nullptr;
    Course course = {};  // of the temperature in time; empty: it stays
  };

  Langevin(const System& sys, const Settings& settings, double h);

  void initialize(const Dynamics& dynamics, double h, State& s) override;
  SolveStats advance(const Dynamics& dynamics, double h, State& s) override;

  const Vectors& half_jump() const { return half_jump_; }  // ½Δ of the step to come [nm/ps]

  void set_temperature(double kelvin);
  void set_friction(double friction);  // [1/ps]
  void serialize(Archive& archive) override { archive(half_jump_, random_); }

 private:
  SolveStats draw(const Dynamics& dynamics, const Push& push, const State& s);
  const Vectors& forces_with_springs(const System& sys, const Push& push, const State& s, SolveStats& stats);
  SolveStats account_for_turning(const System& sys, const State& s);

  Settings settings_;
  double h_;
  DriftVelocity drift_;                 // of the bonds that Δ respects
  State scratch_;                       // with the springs' forces
  Vectors half_jump_, before_, noise_;  // ½Δ, ½Δ of the step before [nm/ps]; M(½Δ_old + ½Δ)/kick [kJ/mol/nm]
  Vectors turned_;                      // P'½Δ of the step before [nm/ps]
  // By how much the heat of the last step's jump, Σ m(v½ + ½Δ)·Δ as if all of it had been tangent, is to be changed
  // since bonds turned [kJ/mol].
  double heat_of_turning_ = 0;
  RandomCounter random_;
  Eigen::VectorXd width_;      // √((1 − c²) kT/m) of each atom [nm/ps]
  std::vector<double> heats_;  // of turning, by blocks of atoms [kJ/mol]
  Aligned<double> normal_;     // R
};

}  // namespace taut
