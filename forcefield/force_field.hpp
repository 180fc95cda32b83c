#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.hpp"
#include "forcefield/external.hpp"
#include "forcefield/terms.hpp"
#include "md/force_law.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Energies by term [kJ/mol].
using Energies = std::vector<std::pair<std::string, double>>;

// Adds up the forces of the terms a scene has. Virtual sites are put in their places first; what pulls at
// them pulls at their parents, and the force on a site is zero. An object keeps pair lists from one call to
// the next, which save time and decide the order of sums, and nothing else.
class ForceField final : public ForceLaw {
 public:
  // Throws InputError for an atom out of range, wrong array sizes, a cutoff over half the
  // box's shortest edge, a switch outside (0, cutoff), a dispersion correction without a periodic cutoff, ...
  ForceField(const System& sys, const Box& box, Terms terms);
  ~ForceField() override;
  ForceField(ForceField&&) noexcept;
  ForceField& operator=(ForceField&&) noexcept;

  // What hangs on the box is made anew where it has changed: lists, the mesh's influence function (its grid
  // and α stay), constants that go as 1/V. Throws SimulationFailure where a cutoff no longer fits it, and for
  // a position that is not finite or absurd, before any force sees it (check_positions.hpp).
  void evaluate(const System& sys, State& s) override;

  // What evaluating the forces at a place gives evaluation them, at no cost. It is kept by the caller, who hands
  // it back for energies and the virial at that place: own fields are never asked twice.
  struct Evaluation {
    std::array<double, 15> bonded{};  // energy by kind of bonded term [kJ/mol]
    double mesh = 0;                  // all of PME but its pairs [kJ/mol]
    Energies fields;  // gravity, pulls, restraints, walls, steering, biases, own fields [kJ/mol]
    std::vector<double> wall_pushes;  // force of the atoms on each wall [kJ/mol/nm]
    SteeringForces steering;          // with the power of biases that move
    BiasForces biases;
    Eigen::Matrix3d site_virial = Eigen::Matrix3d::Zero();  // of handing sites' forces to parents [kJ/mol]
  };
  // Hears (base/listen.hpp) while it makes pair lists, the first of which take longer than the forces, and after each
  // kind of forces. What that throws leaves s.f meaningless and lists that the next call can use or makes anew.
  void evaluate(const System& sys, State& s, Evaluation& evaluation);

  // Sets s.f = F(s.x) and returns the potential energy [kJ/mol].
  double evaluate_energy(const System& sys, State& s);
  // Returns the potential energy without computing the forces of pairs; s.f becomes meaningless [kJ/mol].
  double evaluate_energy_alone(const System& sys, State& s);

  // What in a box would be too narrow for a cutoff; empty: nothing.
  std::string lack_of_room(const Box& box) const;

  // The potential energy at `at`, where evaluate() gave `evaluation` [kJ/mol]. The energies of pairs are summed
  // here: a step that needs none does not pay for them.
  double potential(const State& at, const Evaluation& evaluation);
  // The same term by term, only the terms there are: ("angle", 12.3), ...
  Energies energies(const State& at, const Evaluation& evaluation);

  // −dE/dstrain there, atoms and box strained alike [kJ/mol]; its trace is −3V dE/dV. It is Σ r⊗f of pairs at
  // their nearest images, Σ x⊗f of what acts within molecules, which are whole, and that of biases (bias.hpp) and of
  // the dispersion correction (dispersion.hpp). Fields from outside have none, and so have pairs of atoms that
  // never move.
  Eigen::Matrix3d virial(const State& at, const Evaluation& evaluation);

  // Which pairs are listed, in which order: the order of the sums depends on it.
  void serialize(Archive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
