#pragma once

#include <map>
#include <string>
#include <vector>

#include "systems/openmm/expression.hpp"
#include "systems/openmm/forces.hpp"
#include "systems/openmm/known.hpp"

namespace taut {

// The energy of a custom force and its parameters by the names it declares: of each term (its param1, param2,
// ...) or of all.
class CustomForce {
 public:
  // What kind of force it is: the list of the parameters each term has, and what else its energy may name.
  // Parameters of pairs stand in the energy with the atoms' numbers, as sigma1 and sigma2.
  struct Kind {
    const char* of_each;
    std::vector<Quantity> coordinates;
    bool of_pairs = false;
  };
  CustomForce(const ForceReading& r, Kind kind, const std::string& energy,
              const Expression::Tables& tables = {});

  // Which of the known energies it has; its parameters go by their names from then on. None: -1.
  int recognize(const std::vector<KnownEnergy>& known);
  // `remedy`: what to do instead, if anything.
  [[noreturn]] void refuse_energy(const std::vector<KnownEnergy>& known, const char* remedy = "") const;

  // Reads a term: its own fields, and the parameters it gives.
  void read(const Element& term, std::vector<Field> fields);

  // A known parameter, of the term last read or of all, and what its energy is a multiple of.
  double operator[](const char* known) const;
  double of_all(const char* known) const;
  double factor() const { return recognized_.factor; }

  // Those of each term in their order, as the term last read has them.
  std::vector<double> of_term() const;
  // Of atoms with these parameters, r apart.
  double pair_energy(const std::vector<double>& one, const std::vector<double>& two, double r) const;

 private:
  struct OfEach {
    std::string attribute, name;
  };
  Expression parsed(const std::string& energy, const Expression::Tables& tables) const;
  void add(const Element& at, const std::string& name, double value);
  void check_names() const;

  const Element& force_;
  Kind kind_;
  std::vector<OfEach> of_each_;
  Expression::Values values_;
  std::string text_;
  Expression energy_;
  Recognized recognized_{1, {}};
};

// Refuses whatever these lists of a force hold.
void refuse_any(const Element& force, std::initializer_list<const char*> lists);

}  // namespace taut
