#pragma once

#include <vector>

#include "md/account.hpp"
#include "md/bath.hpp"
#include "md/constraint_method.hpp"
#include "md/force_law.hpp"
#include "md/moving_anchors.hpp"

namespace taut {

// What moves a system: forces, the method that holds its bonds, and what acts on velocities and box besides.
struct Dynamics {
  const System& sys;
  ForceLaw& forces;
  ConstraintMethod& method;
  Bath& bath = no_bath();
  MovingAnchors* anchors = nullptr;  // null: all stand

  // Before the drift: gives anchors that move their v½.
  void set_off(double h, State& s) const {
    if (anchors) anchors->set_off(h, s);
  }
  // The method's stages, with what anchors that move do in them. What they take is the bonds' part of the step
  // (md/step_parts.hpp).
  SolveStats project_positions(double h, State& s) const;
  SolveStats add_forces(Push push, State& s) const;
  SolveStats project_velocities(double h, State& s) const;
  // The bath's stage at the step's end. Returns the heat.
  double after_step(double h, State& s) const;
};

// A rule by which dynamics moves a state from step to step.
class Integrator {
 public:
  virtual ~Integrator() = default;

  // Gives f and F their first values, where the bonds hold, for steps of length h [ps]. Throws SimulationFailure,
  // naming the bond, where the method cannot hold them.
  virtual void initialize(const Dynamics& dynamics, double h, State& s) = 0;
  // One whole step. Where its bonds do not hold (SolveStats::held), its end is left out.
  virtual SolveStats advance(const Dynamics& dynamics, double h, State& s) = 0;
  // What it takes from one step to the next besides the state and its account.
  virtual void serialize(Archive&) {}

  Account account;  // of its steps

 protected:
  // Sets F to the forces f that were evaluated where a drift of the velocity v ended, and takes their work in it into
  // account. Where a thermostat changed the velocity by Δ in the middle, v is v½ + ½Δ, and ½Δ is given.
  void renew_forces(double h, const System& sys, const Vectors* half_jump, State& s);

 private:
  std::vector<Account> shares_;  // by thread
};

// v += (h/2) M⁻¹f, after a thermostat's ½Δ where there is one; and the same with ½Δ after the kick, then x += hv.
void half_kick(const System& sys, double h, const Vectors* half_jump, State& s);
void half_kick_and_drift(const System& sys, double h, const Vectors* half_jump, State& s);

}  // namespace taut
