#pragma once

#include "base/errors.hpp"
#include "constraints/metric_potential.hpp"
#include "forcefield/terms.hpp"

namespace taut {

// Fixman's potential of the rigid bonds as a field (constraints/metric_potential.hpp).
class MetricField final : public OwnField {
 public:
  MetricField(const System& sys, double kT) : potential_(sys), kT_(kT) {
    if (!sys.reach.empty())
      throw InputError(
          "run.metric_correction: depends on the shapes of whole molecules, and a molecule is bonded around "
          "the box to its own image; leave it out");
  }

  std::string name() const override { return "metric correction"; }
  double add(const Vectors& x, Vectors& f) override { return potential_.add_forces(x, kT_, f); }
  Kind kind() const override { return Kind::kWithinMolecules; }

  void set_kT(double kT) { kT_ = kT; }

 private:
  MetricPotential potential_;
  double kT_;  // [kJ/mol]
};

}  // namespace taut
