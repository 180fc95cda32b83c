#pragma once

#include "base/random.hpp"
#include "ensembles/barostat.hpp"
#include "md/bath.hpp"
#include "md/centre_scaling.hpp"
#include "md/units.hpp"

namespace taut {

// Monte Carlo, isotropic (Chow and Ferguson 1995, doi:10.1016/0010-4655(95)00059-O; Åqvist et al. 2004,
// doi:10.1016/j.cplett.2003.12.039), as OpenMM has it: of N molecules moved by their centres a volume V' = V
// + ΔV, |ΔV| up to a largest one, is taken with the probability
//     min(1, exp(−W/kT)),   W = U' − U + P₀(V' − V) − N kT ln(V'/V),
// velocities as they are. Every ten trials the largest ΔV changes where less than a quarter or more than
// three quarters were taken: by a tenth at first, then less and less, or what is sampled would be another
// distribution (Roberts and Rosenthal 2007, doi:10.1239/jap/1183667414). A box that is too narrow for a
// cutoff, or in which forces have no value, is never taken: volumes end there as at a wall, which is a doubt.
class MonteCarloBarostat final : public Bath {
 public:
  // molecule: of each atom, counted from 0.
  MonteCarloBarostat(const System& sys, const std::vector<int>& molecule, const PressureCoupling& coupling,
                     RunForces& forces);

  double move_box(const System& sys, State& s) override;
  double after_step(const System&, double, State&) override {
    ++steps_;
    return 0;
  }
  void set_temperature(double kelvin) override { coupling_.kT = kBoltzmann * kelvin; }
  void serialize(Archive& archive) override {
    archive(steps_, largest_, tried_, taken_, adapted_, random_);
    archive.demand_count(steps_);
    archive.demand_count(adapted_);
    archive.demand(largest_ >= 0 && 0 <= taken_ && taken_ <= tried_ && tried_ < kTrials);
  }
  std::string doubt() const override;

 private:
  static constexpr int kTrials = 10;
  double energy(const System& sys);  // of trial_
  double energy_of_box(const System& sys);
  void adapt();

  CentreScaling centres_;
  RunForces& forces_;
  PressureCoupling coupling_;
  long steps_ = 0;
  double largest_ = 0;  // ΔV [nm³]
  int tried_ = 0, taken_ = 0;
  long adapted_ = 0;
  long trials_ = 0, too_narrow_ = 0, without_energy_ = 0;  // since it was made
  std::string why_without_energy_;                         // the first
  State trial_;
  RandomCounter random_;
};

}  // namespace taut
