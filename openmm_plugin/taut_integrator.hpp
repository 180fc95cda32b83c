#pragma once

#include <openmm/Integrator.h>
#include <openmm/Kernel.h>

#include <functional>

#include "openmm_plugin/held_dynamics.hpp"

namespace taut {

// An OpenMM integrator that holds the System's constraints, and bonds of its own, by taut's methods: velocity
// Verlet, or with a friction Langevin's dynamics (BAOAB). Velocities are those of full steps. OpenMM's own
// constraint algorithms take no part in the step, nor in applyConstraints(), nor for new velocities.
class TautIntegrator : public OpenMM::Integrator {
 public:
  explicit TautIntegrator(const HoldSettings& settings);

  const HoldSettings& settings() const { return settings_; }
  // The random numbers' seed, where 0 has been replaced for this Context.
  std::uint64_t seed_in_use() const { return seed_in_use_; }
  void set_bath(double temperature, double friction);
  // The temperature of the Context's kinetic energy, of as many degrees of freedom as the bonds leave [K].
  double temperature();
  void set_seed(std::uint64_t seed) { settings_.seed = seed; }  // counts for Contexts to come

  void setStepSize(double size) override;
  double getConstraintTolerance() const override;
  void setConstraintTolerance(double tolerance) override;  // of the method; refused where it has none
  void setIntegrationForceGroups(int groups) override;
  void step(int steps) override;

 protected:
  void initialize(OpenMM::ContextImpl& context) override;
  void cleanup() override;
  std::vector<std::string> getKernelNames() override;
  void stateChanged(OpenMM::State::DataType changed) override;
  double computeKineticEnergy() override;
  bool kineticEnergyRequiresForce() const override { return false; }
  void createCheckpoint(std::ostream& stream) const override;
  void loadCheckpoint(std::istream& stream) override;
  void serializeParameters(OpenMM::SerializationNode& node) const override;
  void deserializeParameters(const OpenMM::SerializationNode& node) override;

 private:
  void demand_molecules() const;
  void make_kernel();
  void change(const HoldSettings& settings);

  HoldSettings settings_;
  std::uint64_t seed_in_use_ = 0;
  bool loading_ = false;   // a checkpoint, which OpenMM is still speaking of
  OpenMM::Kernel kernel_;  // null before there is a Context
};

// The System's masses, its constraints, and the bonds besides.
HeldBonds held_bonds(const OpenMM::System& system, const HoldSettings& settings);

// Calls work(); taut's exceptions become OpenMM's, with the same words.
void in_openmm_words(const std::function<void()>& work);

}  // namespace taut
