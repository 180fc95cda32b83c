#include "ensembles/ensemble.hpp"

#include "md/observables.hpp"
#include "md/step_parts.hpp"

namespace taut {

double Ensemble::move_box(const System& sys, State& s) {
  for (Bath* bath : {thermostat.get(), barostat.get()})
    if (bath && !temperature.empty()) bath->set_temperature(temperature.at(s.t));
  return barostat ? barostat->move_box(sys, s) : 0;
}

double Ensemble::after_step(const System& sys, double h, State& s) {
  double heat = 0;
  if (steering) steering->add_step(h);
  if (thermostat) heat += in_part(StepPart::kThermostat, [&] { return thermostat->after_step(sys, h, s); });
  ++steps_;
  if (remove_momentum_every > 0 && steps_ % remove_momentum_every == 0)
    in_part(StepPart::kThermostat, [&] { remove_momentum(sys, s.v); });  // what rounding left
  if (barostat) heat += barostat->after_step(sys, h, s);
  return heat;
}

void Ensemble::serialize(Archive& archive) {
  archive(steps_);
  archive.demand_count(steps_);
  if (steering) archive(*steering);
  if (thermostat) archive(*thermostat);
  if (barostat) archive(*barostat);
}

}  // namespace taut
