#pragma once

#include <memory>

#include "md/bath.hpp"
#include "md/work_meter.hpp"

namespace taut {

// Thermostat, barostat and what takes the momentum out, one after the other; it meters their heat and the
// work of the forces.
class Ensemble final : public Bath {
 public:
  std::unique_ptr<Bath> thermostat, barostat;  // null: none
  long remove_momentum_every = 0;              // steps; 0: never
  WorkMeter meter;

  const Vectors* half_jump() const override { return thermostat ? thermostat->half_jump() : nullptr; }
  double move_box(const System& sys, State& s) override;
  Draw draw(const System& sys, const Push& push, const State& s) override;
  double after_step(const System& sys, double h, State& s) override;
  void serialize(Archive& archive) override;
  std::string doubt() const override { return barostat ? barostat->doubt() : ""; }

 private:
  double take_momentum_out(const System& sys, State& s);

  long steps_ = 0;
};

}  // namespace taut
