#include "ensembles/ensemble.hpp"

#include "md/observables.hpp"
#include "md/step_parts.hpp"

namespace taut {

void Ensemble::follow_temperature(double t) {
  if (temperature.empty()) return;
  for (Bath* bath : {thermostat.get(), barostat.get()})
    if (bath) bath->set_temperature(temperature.at(t));
}

// The first stage of a step.
double Ensemble::move_box(const System& sys, State& s) {
  follow_temperature(s.t);
  if (!barostat) return 0;
  const double heat = barostat->move_box(sys, s);
  meter.add_heat(heat);
  return heat;
}

Bath::Draw Ensemble::draw(const System& sys, const Push& push, const State& s) {
  in_part(StepPart::kAccount, [&] { meter.add_step(push.h, sys, s, half_jump()); });
  if (push.starts()) follow_temperature(s.t);
  if (steering && push.starts()) steering->begin();
  if (steering && !push.starts()) steering->add_step(push.h);
  if (barostat) barostat->draw(sys, push, s);
  if (!thermostat) return {};
  const Draw drawn = in_part(StepPart::kThermostat, [&] { return thermostat->draw(sys, push, s); });
  meter.add_heat(drawn.heat);
  return drawn;
}

double Ensemble::after_step(const System& sys, double h, State& s) {
  double heat = 0;
  if (thermostat) heat += in_part(StepPart::kThermostat, [&] { return thermostat->after_step(sys, h, s); });
  ++steps_;
  if (remove_momentum_every > 0 && steps_ % remove_momentum_every == 0)
    in_part(StepPart::kThermostat, [&] { remove_momentum(sys, s.v); });  // what rounding left
  if (barostat) heat += barostat->after_step(sys, h, s);
  meter.add_heat(heat);
  return heat;
}

void Ensemble::serialize(Archive& archive) {
  archive(steps_, meter);
  archive.demand_count(steps_);
  if (steering) archive(*steering);
  if (thermostat) archive(*thermostat);
  if (barostat) archive(*barostat);
}

}  // namespace taut
