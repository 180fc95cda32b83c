#pragma once

#include <memory>
#include <string>

#include "base/archive.hpp"
#include "base/random.hpp"
#include "forcefield/force_field.hpp"
#include "md/centre_scaling.hpp"
#include "systems/scene.hpp"

namespace taut {

// Keeps a pressure by changing the box. What it moves, it moves where a step has drifted and evaluates its
// forces next: so they are evaluated no more often, and are always those of the box there is.
class Barostat {
 public:
  virtual ~Barostat() = default;
  // May change the box, with it x and v. Returns what it gives to the kinetic energy [kJ/mol].
  virtual double move(const System& sys, State& s) = 0;
  // At a step's end; F: the forces at x but for constraints'.
  virtual void after_step(const State& s, const Vectors& F, const ForceField::Evaluation& besides) = 0;
  virtual void serialize(Archive& archive) = 0;
  virtual std::string doubt() const { return ""; }  // what speaks against the volumes it gave; empty: nothing
};

// Stochastic cell rescaling (Bernetti and Bussi 2020, doi:10.1063/5.0020514; along edges each for itself, Del
// Tatto et al. 2022, doi:10.3390/app12031139). k edges that change alike, all 3 of them or fewer, have the
// strain ε = Σ ln L, which relaxes to its distribution at the pressure P₀:
//     dε = (kβ/3τ)(P − P₀) dt + √(2k kT β/(3Vτ)) dW,   P the mean over these edges of
//     P = (Σ M V² + Ξ − Σ (x − X) f)/V,
// the pressure of the centres that the box moves (md/centre_scaling.hpp), in which constraints have no part:
// Ξ is the virial of all other forces f. The equation is linear where β is the compressibility, and is taken
// over a time t at once,
//     Δε = (kβ/3)(1 − c)(P − P₀) + √((1 − c²) k kT β/(3V)) R,   c = exp(−t/τ),
// so that the distribution does not depend on how often, nor on τ, which sets the pace alone. A β that is s
// times the compressibility sets the pace, too, while t is short for τ: it makes the variance of the volume
// (1 + c)/(2 − s(1 − c)) times what it is, 1 + (s − 1)t/2τ.
//
// It stops, by a SimulationFailure, a box that shrinks to twice a cutoff, and one whose edges go apart
// tenfold: nothing holds the shape of a fluid's box whose edges change each for itself.
class CellRescaling final : public Barostat {
 public:
  CellRescaling(const Scene& scene, std::uint64_t seed, ForceField& forces);

  double move(const System& sys, State& s) override;
  void after_step(const State& s, const Vectors& F, const ForceField::Evaluation& besides) override;
  void serialize(Archive& archive) override { archive(steps_, strain_, random_); }

  // P along x, y and z; the forces have been evaluated at s, F but for constraints' [kJ/mol/nm³].
  Vec3 pressure(const State& s, const Vectors& F, const ForceField::Evaluation& besides) const;

 private:
  void demand_sound(const Box& box) const;

  CentreScaling centres_;  // of what rigid bonds tie together
  ForceField& forces_;
  const Vec3 start_;          // the edges of the scene's start [nm]
  std::array<int, 3> alike_;  // edges with the same number change alike
  double pressure_, kT_;      // [kJ/mol/nm³], [kJ/mol]
  double compressibility_;    // [nm³·mol/kJ]
  double kept_;               // c
  long every_, steps_ = 0;
  Vec3 strain_ = Vec3::Zero();  // to come
  RandomCounter random_;
};

// Monte Carlo, isotropic (Chow and Ferguson 1995, doi:10.1016/0010-4655(95)00059-O; Åqvist et al. 2004,
// doi:10.1016/j.cplett.2003.12.039), as OpenMM has it: of N molecules moved by their centres a volume V' = V
// + ΔV, |ΔV| up to a largest one, is taken with the probability
//     min(1, exp(−W/kT)),   W = U' − U + P₀(V' − V) − N kT ln(V'/V),
// velocities as they are. Every ten trials the largest ΔV changes where less than a quarter or more than
// three quarters were taken: by a tenth at first, then less and less, or what is sampled would be another
// distribution (Roberts and Rosenthal 2007, doi:10.1239/jap/1183667414). A box that is too narrow for a
// cutoff is never taken: volumes end there as at a wall, which is a doubt.
class MonteCarloBarostat final : public Barostat {
 public:
  // molecule: of each atom, counted from 0.
  MonteCarloBarostat(const System& sys, const std::vector<int>& molecule, const RunSettings& run,
                     std::uint64_t seed, ForceField& forces);

  double move(const System& sys, State& s) override;
  void after_step(const State&, const Vectors&, const ForceField::Evaluation&) override { ++steps_; }
  void serialize(Archive& archive) override {
    archive(steps_, largest_, tried_, taken_, adapted_, random_);
    archive.demand(largest_ >= 0 && 0 <= taken_ && taken_ <= tried_ && tried_ < kTrials && adapted_ >= 0);
  }
  std::string doubt() const override;

 private:
  static constexpr int kTrials = 10;
  double energy(const System& sys);  // of trial_
  void adapt();

  CentreScaling centres_;
  ForceField& forces_;
  double pressure_, kT_;  // [kJ/mol/nm³], [kJ/mol]
  long every_, steps_ = 0;
  double largest_ = 0;  // ΔV [nm³]
  int tried_ = 0, taken_ = 0;
  long adapted_ = 0;
  long trials_ = 0, too_narrow_ = 0;  // since it was made
  State trial_;
  RandomCounter random_;
};

// The one a scene asks for, or none.
std::unique_ptr<Barostat> make_barostat(const Scene& scene, std::uint64_t seed, ForceField& forces);

}  // namespace taut
