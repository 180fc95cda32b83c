#pragma once

#include <cstdint>

#include "base/random.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "md/bath.hpp"

namespace taut {

// Langevin's thermostat in the middle of the drift, with the jump Δ in the tangent space of the bonds:
// ensembles/langevin.hpp has the equations and their sources. This form gives no account of its heat, and
// needs nothing of the folder forcefield, which is linked with FFTW.
class LangevinNoise : public Bath {
 public:
  LangevinNoise(const System& sys, double temperature, double friction, std::uint64_t seed, double h);

  void set(const System& sys, double temperature, double friction);
  bool acts() const { return friction_ > 0; }
  void restart(const System& sys);  // forgets Δ, but not how many were drawn

  const Vectors* half_jump() const override { return acts() ? &half_jump_ : nullptr; }
  Draw draw(const System& sys, const Push& push, const State& s) override;
  void serialize(Archive& archive) override { archive(half_jump_, random_); }

  SolveStats project(const System& sys, const Vectors& x, Vectors& v);  // v = Pv at x

 private:
  double h_, friction_ = 0;
  Batched<Newton> projector_;
  State scratch_;                       // x and v as the projector takes them
  Vectors half_jump_, before_, noise_;  // ½Δ, ½Δ of the step before [nm/ps]; M(½Δ_old + ½Δ)/kick [kJ/mol/nm]
  RandomCounter random_;
  Eigen::VectorXd width_;  // √((1 − c²) kT/m) of each atom [nm/ps]
};

}  // namespace taut
