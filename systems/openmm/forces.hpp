#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/system.hpp"
#include "systems/openmm/read.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// The global parameters of custom forces, which belong to all of a System's forces together.
class ContextParameters {
 public:
  // What the State has of them.
  explicit ContextParameters(std::map<std::string, double> of_state) : of_state_(std::move(of_state)) {}

  // A force declares one. Its value is the State's, if that has it, else the default.
  double declare(const Element& at, const std::string& name, double default_value);
  // The first of the State's that no force declares.
  std::optional<std::string> undeclared() const;

 private:
  std::map<std::string, double> of_state_, defaults_;
};

// What one <Force> is made of.
struct OpenMMForce {
  Terms terms;
  std::optional<Nonbonded> lennard_jones;  // of a CustomNonbondedForce, its exceptions plain exclusions
  std::vector<PairException> pairs;        // Lennard-Jones of a CustomBondForce
  bool takes_images = false;               // bonded terms and exceptions, between nearest images
  std::optional<bool> periodic_pairs;      // of a pair force
  long remove_momentum_every = 0;          // steps; 0: never
  std::vector<std::string> notes{};        // what of it is carried out otherwise
  std::optional<OpenMMBarostat> barostat{};
};

// Reads a <Force> of a System with these atoms. Throws InputError, with file and line, for what taut does not
// carry out: nothing is skipped but what has no effect on the forces (groups, names, settings of PME).
OpenMMForce read_force(const Element& force, const System& system, ContextParameters& context);

// The version in which a force that read_force knows is written: OpenMM 7.7 and 8.6 both read it.
int version_written(std::string_view type);

// What read_force hands to the readers of custom forces.
struct ForceReading {
  const Element& force;
  const System& system;
  ContextParameters& context;
  OpenMMForce& to;

  // All attributes of the force: those every force has, which change nothing (all groups are computed
  // together), and as Element::read has it.
  void read(const std::vector<Field>& fields, std::vector<std::string_view> unused = {}) const;
  void check_count(const Element& particles) const;  // one for each atom
};
void read_custom_external(const ForceReading& r);
void read_custom_bonds(const ForceReading& r);
void read_custom_angles(const ForceReading& r);
void read_custom_torsions(const ForceReading& r);
void read_custom_nonbonded(const ForceReading& r);

}  // namespace taut
