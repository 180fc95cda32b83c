#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/system.hpp"
#include "systems/openmm/input.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// The global parameters of custom forces, which all forces of a System share.
class ContextParameters {
 public:
  // The values in the State.
  explicit ContextParameters(std::map<std::string, double> of_state) : of_state_(std::move(of_state)) {}

  // Declares a parameter of a force. Its value is the State's if it has one, else the default.
  double declare(const Element& at, const std::string& name, double default_value);
  // Returns the first parameter of the State that no force declares.
  std::optional<std::string> undeclared() const;

 private:
  std::map<std::string, double> of_state_, defaults_;
};

// The reaction field between two charges that exclude each other, or of an atom's charge on itself.
struct ExcludedCharges {
  int i, j;
  double coulomb;  // times their product; half of it where i = j [kJ/mol·nm]
  double cutoff;   // [nm]
};

// The parts of one <Force>.
struct OpenMMForce {
  Terms terms;
  std::optional<Nonbonded> lennard_jones;  // from a CustomNonbondedForce; its exceptions are exclusions
  std::vector<PairException> pairs;        // Lennard-Jones pairs of a CustomBondForce
  std::vector<ExcludedCharges> excluded_charges;  // of a CustomBondForce
  bool takes_images = false;                      // whether bonded terms and exceptions use nearest images
  std::optional<bool> periodic_pairs;             // whether a pair force is periodic
  long remove_momentum_every = 0;                 // steps; 0: never
  std::vector<std::string> notes{};               // messages about what is done differently
  std::optional<OpenMMBarostat> barostat{};
};

// Reads a <Force> of a System with these atoms. Throws InputError, with file and line, for anything that taut
// does not support. Only attributes without effect on the forces are skipped (groups, names).
OpenMMForce read_force(const Element& force, const System& system, ContextParameters& context);

// Returns the version to write for a force that read_force() knows; OpenMM 7.7 and 8.6 both read it.
int version_written(std::string_view type);

// The arguments that read_force() passes to the readers of custom forces.
struct ForceReading {
  const Element& force;
  const System& system;
  ContextParameters& context;
  OpenMMForce& to;

  // Reads the attributes of the force as Element::read() does, and skips those that every force has and that
  // have no effect (all groups are computed together).
  void read(const std::vector<Field>& fields, std::vector<std::string_view> unused = {}) const;
  void check_count(const Element& particles) const;  // throws if there is not one for each atom
};
void read_custom_external(const ForceReading& r);
void read_custom_bonds(const ForceReading& r);
void read_custom_angles(const ForceReading& r);
void read_custom_compound(const ForceReading& r);
void read_custom_centroid(const ForceReading& r);
void read_custom_cv(const ForceReading& r);
void read_custom_torsions(const ForceReading& r);
void read_custom_nonbonded(const ForceReading& r);

}  // namespace taut
