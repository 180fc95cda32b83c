#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "base/course.hpp"
#include "forcefield/force_field.hpp"
#include "md/bath.hpp"

namespace taut {

// The work that the moving ends of springs do, ∫ Σ force × speed dt, by the trapezoidal rule, which is exact for
// the energy of a step of velocity Verlet.
class SteeringWork {
 public:
  explicit SteeringWork(const ForceField::Evaluation& now) : now_(now) {}

  void begin() { before_ = now_.steering.power; }
  void add_step(double h) {
    work_ += 0.5 * h * (std::exchange(before_, now_.steering.power) + now_.steering.power);
  }
  double work() const { return work_; }  // so far [kJ/mol]

  void serialize(Archive& archive) { archive(work_, before_); }

 private:
  const ForceField::Evaluation& now_;  // of the forces evaluated last
  double work_ = 0, before_ = 0;       // power at the step before [kJ/mol/ps]
};

// A thermostat that scales velocities, a barostat and what takes the momentum out, one after the other.
class Ensemble final : public Bath {
 public:
  std::unique_ptr<Bath> thermostat, barostat;  // null: none
  long remove_momentum_every = 0;              // steps; 0: never
  Course temperature;                          // of thermostat and barostat; empty: they keep theirs
  std::optional<SteeringWork> steering;        // none: no atom is steered

  double move_box(const System& sys, State& s) override;
  double after_step(const System& sys, double h, State& s) override;
  void serialize(Archive& archive) override;
  std::string doubt() const override { return barostat ? barostat->doubt() : ""; }

 private:
  long steps_ = 0;
};

}  // namespace taut
