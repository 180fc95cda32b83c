#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "systems/openmm/forces.hpp"
#include "systems/openmm/known_energies.hpp"

namespace taut {

// The energy of a custom force, and its parameters by the names that it declares: per-term parameters
// (param1, param2, ...) and global ones.
class CustomForce {
 public:
  // The kind of force: the name of its list of per-term parameters (null: it has none), and the other names that its energy may
  // contain. Parameters of pairs appear in the energy with the atoms' numbers, as sigma1 and sigma2.
  struct Kind {
    const char* of_each;
    std::vector<Quantity> coordinates;
    bool of_pairs = false;
  };
  CustomForce(const ForceReading& r, Kind kind, const std::string& energy,
              const Expression::Tables& tables = {});

  // Returns the index of the known energy that it is, or -1. From then on its parameters, and numbers that stand
  // in their place, have the known names.
  int recognize(const std::vector<KnownEnergy>& known);
  // Refuses the energy. `remedy`: what to do instead.
  [[noreturn]] void refuse_energy(const std::vector<KnownEnergy>& known, const char* remedy = "") const;
  bool names(const std::string& name) const { return energy_.names().contains(name); }

  // Reads a term: its own fields and its parameters.
  void read(const Element& term, std::vector<Field> fields);

  // Returns a known parameter of the last term read, or a global one; and the factor of the energy.
  double operator[](const char* known) const;
  double of_all(const char* known) const;
  double factor() const { return recognized_.factor; }

  // Returns the energy at these coordinates, with the parameters of the last term read.
  double energy(const Expression::Values& coordinates) const;
  // Whether the formula may be another one from some point on.
  bool branches() const { return !energy_.branches().empty(); }
  // Whether it is linear in the coordinates, whatever the parameters are.
  bool linear() const;
  // Whether it is a law of its one coordinate throughout, with the parameters of the last term read, or of two atoms.
  // The law says what it is uncertain by; infinity where it does not count.
  using Law = std::function<Expression::Rough(double)>;
  bool is(const Law& law) const { return is(law, values_); }
  bool is(const Law& law, const std::vector<double>& one, const std::vector<double>& two) const {
    return is(law, of_pair(one, two));
  }
  // Returns the per-term parameters of the last term read, in their order.
  std::vector<double> of_term() const;
  // Returns the energy of two atoms with these parameters at distance r.
  double pair_energy(const std::vector<double>& one, const std::vector<double>& two, double r) const;

 private:
  struct OfEach {
    std::string attribute, name;
  };
  Expression parsed(Expression::Numbers named) const;
  void add(const Element& at, const std::string& name, double value);
  void check_names() const;
  bool is(const Law& law, const Expression::Values& parameters) const;
  Expression::Values of_pair(const std::vector<double>& one, const std::vector<double>& two) const;

  const Element& force_;
  Kind kind_;
  std::vector<OfEach> of_each_;
  Expression::Values values_;
  std::string text_;
  Expression::Tables tables_;
  Expression energy_;
  Recognized recognized_{1, {}};
  std::vector<Quantity> ranges_;  // of the known energy's parameters
};

// Returns an energy of groups or points as one of a variable v: v stands in place of distance(g1,g2), angle(g1,g2,g3) or
// dihedral(g1,g2,g3,g4), in this order or backwards. Nothing where the energy has another function of groups.
std::optional<std::string> with_variable(const std::string& energy, const std::string& function,
                                         const std::string& letter, int groups);

// Refuses these lists of a force unless they are empty.
void refuse_any(const Element& force, std::initializer_list<const char*> lists);

}  // namespace taut
