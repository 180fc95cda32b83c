#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.hpp"
#include "forcefield/terms.hpp"
#include "md/force_law.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Adds up the forces of the terms a scene has. Virtual sites are put in their places first; what pulls at
// them pulls at their parents, and the force on a site is zero.
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
  void operator()(const System& sys, State& s) override;

  // What in a box would be too narrow for a cutoff; empty: nothing.
  std::string lack_of_room(const Box& box) const;

  // Of the last evaluation [kJ/mol]. The energies of pairs are summed when first asked for: a step that does
  // not ask does not pay.
  double potential() const override;
  // the same, a term at a time, only the terms there are: ("angle", 12.3), ...
  std::vector<std::pair<std::string, double>> energies() const;

  // −dE/dstrain of that evaluation, atoms and box strained alike [kJ/mol]; its trace is −3V dE/dV. Σ r⊗f of
  // pairs at their nearest images, Σ x⊗f of what acts within molecules, which are whole, and the dispersion
  // correction's (dispersion.hpp). Fields from outside have none.
  Eigen::Matrix3d virial(const Vectors& x) const;

  // What own fields said in the last evaluation, so that nobody has to ask them again.
  struct Answers {
    std::vector<std::pair<std::string, double>> energies;  // of all fields from outside [kJ/mol]
    Eigen::Matrix3d handed_virial;
  };
  void note(Answers& answers) const;
  // As if the last evaluation had been the one at s that gave these answers. The lists are recalled before.
  void return_to(const System& sys, State& s, const Answers& answers);

  // Which pairs are listed, in which order: what the order of the sums depends on. Recalled, the forces are
  // to be evaluated before energies are asked for.
  void serialize(Archive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
