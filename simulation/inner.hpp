#pragma once

#include <memory>
#include <optional>
#include <string>

#include "constraints/projection.hpp"
#include "ensembles/barostat.hpp"
#include "ensembles/drift_velocity.hpp"
#include "ensembles/ensemble.hpp"
#include "ensembles/langevin.hpp"
#include "ensembles/pressure.hpp"
#include "md/moving_anchors.hpp"
#include "md/velocity_verlet.hpp"
#include "simulation/held_bonds.hpp"
#include "simulation/metric_field.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// The barostat that a scene asks for; null: none. Throws InputError.
std::unique_ptr<Bath> make_barostat(const Scene& scene, std::uint64_t seed, RunForces& forces);

// What a method is refused for, at the start or later. A coordinate is known to 1e-16 of itself, so a bond's length to
// no better than that over its length.
void refuse_unreachable_tolerance(const System& sys, const Vectors& x, double tolerance);
void refuse_springs_under_metric(const ConstraintMethod& method);

// What moves a simulation's atoms and measures their pressure.
struct Simulation::Inner {
  explicit Inner(Scene& scene);  // adds the metric correction to the scene's terms

  Dynamics dynamics(const System& sys, ConstraintMethod& method) {
    return {sys, forces, method, ensemble, anchors.empty() ? nullptr : &anchors};
  }
  // λ that hold the bonds at this very instant. s.f must not contain constraint forces.
  const Eigen::VectorXd& multipliers(const System& sys, const State& s) {
    return projector.multipliers(sys, s, anchors.empty() ? nullptr : &anchors.accelerations(s));
  }
  Langevin* langevin() const { return dynamic_cast<Langevin*>(integrator.get()); }

  std::shared_ptr<MetricField> metric;  // of the scene; null: no metric correction
  RunForces forces;
  Ensemble ensemble;
  MovingAnchors anchors;
  std::unique_ptr<Integrator> integrator = std::make_unique<VelocityVerlet>();
  Projector projector;
  DriftVelocity drift;
  std::optional<HeldBonds> held;  // of run.tension_of
  struct Note {
    std::string numbers;                // what serialize_numbers() kept
    ForceField::Evaluation evaluation;  // of the forces at that state
  };
  Note note;
};

}  // namespace taut
