#pragma once

#include "base/random.hpp"
#include "ensembles/barostat.hpp"
#include "md/bath.hpp"
#include "md/centre_scaling.hpp"
#include "md/units.hpp"

namespace taut {

// Stochastic cell rescaling (Bernetti and Bussi 2020, doi:10.1063/5.0020514; along edges each for itself, Del
// Tatto et al. 2022, doi:10.3390/app12031139). k edges that change alike, all 3 of them or fewer, have the
// strain ε = Σ ln L, which relaxes to its distribution at the pressure P₀:
//     dε = (kβ/3τ)(P − P₀) dt + √(2k kT β/(3Vτ)) dW,   P the mean over these edges of
//     P = (Σ M V² + Ξ − Σ (x − X) F)/V,
// the pressure of the centres that the box moves (md/centre_scaling.hpp), in which constraints have no part:
// Ξ is the virial of all other forces F, and V the velocity of the drift ahead, that of the full step and ½hf/M, f all
// forces: a centre's is too cold by (ωh)²/4 at the full step (docs/ensembles.md). The equation is linear where β is the
// compressibility, and is taken over a time t at once,
//     Δε = (kβ/3)(1 − c)(P − P₀) + √((1 − c²) k kT β/(3V)) R,   c = exp(−t/τ),
// so that the distribution does not depend on how often, nor on τ, which sets the pace alone. A β that is s
// times the compressibility sets the pace, too, while t is short for τ: it makes the variance of the volume
// (1 + c)/(2 − s(1 − c)) times what it is, 1 + (s − 1)t/2τ.
//
// It stops, by a SimulationFailure, a box that shrinks to twice a cutoff, and one whose edges go apart
// tenfold: nothing holds the shape of a fluid's box whose edges change each for itself.
class CellRescaling final : public Bath {
 public:
  // group: of each atom, counted from 0; what rigid bonds tie together. start: the box of the start.
  CellRescaling(const System& sys, const std::vector<int>& group, const Box& start,
                const PressureCoupling& coupling, RunForces& forces);

  double move_box(const System& sys, State& s) override;
  double after_step(const System& sys, double h, State& s) override;
  void set_temperature(double kelvin) override { coupling_.kT = kBoltzmann * kelvin; }
  void serialize(Archive& archive) override {
    archive(steps_, strain_, random_);
    archive.demand_count(steps_);
  }

  // P along x, y and z where the forces were evaluated last, at a full step of length h [kJ/mol/nm³].
  Vec3 pressure(double h, const State& s) const;

 private:
  void demand_sound(const Box& box) const;

  CentreScaling centres_;
  RunForces& forces_;
  PressureCoupling coupling_;
  const Vec3 start_;  // edges of the start's box [nm]
  double kept_;       // c
  long steps_ = 0;
  Vec3 strain_ = Vec3::Zero();  // to come
  RandomCounter random_;
};

}  // namespace taut
