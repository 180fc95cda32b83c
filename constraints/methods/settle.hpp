#pragma once

#include <array>
#include <string>
#include <vector>

#include "constraints/batch/solving.hpp"
#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// SETTLE (Miyamoto and Kollman 1992, doi:10.1002/jcc.540130805) for rigid triangles with two equal sides and
// equal masses at their far ends (water). Three rotations φ, ψ, θ about the axes of the triangle before the
// step restore its shape in closed form; the 3 × 3 system A g = −J v gives its velocities, as in Newton. Any
// other cluster is refused by name, unless the option `solute` names a method for it (settle_beside.hpp).
// Cost: per water three square roots for the axes and four for the rotations.
class Settle : public ConstraintMethod {
 public:
  struct Options {
    std::string solute = "none";

    std::vector<Option> describe() {
      return {{"solute",
               &solute,
               "the method, at its defaults, for bonds that are no water's; none: they are refused",
               {.words = {"none", "newton", "feedforward", "baumgarte", "rattle", "lincs", "mshake"}}}};
    }
  };

  struct Water {
    int apex, left, right;     // atoms
    std::array<int, 3> bonds;  // apex–left, apex–right, left–right
    double ra, rb, rc;         // apex to centre of mass, centre of mass to base, half the base [nm]
  };
  // Waters of one shape, with atoms apex, left, right and bonds apex–left, apex–right, left–right.
  struct Batch : SolvedBatch {
    double ra, rb, rc;

    Batch(const ClusterBatch& batch, const Water& water)
        : SolvedBatch(batch), ra(water.ra), rb(water.rb), rc(water.rc) {}

    void serialize(Archive& archive) { archive(lambda); }
  };
  // Throws InputError for a bond that is not part of a water.
  static std::vector<Water> find_waters(const System& sys);

  struct Parts {
    std::vector<int> of_waters, rest;  // bonds
  };
  static Parts parts_of(const System& sys);

  Settle(const System& sys, const Options& options, double h);

  SolveStats project_positions(const System& sys, double h, State& s) override;
  SolveStats project_velocities(const System& sys, double h, State& s) override;

  void serialize(Archive& archive) override { archive(batches_); }
  const Eigen::VectorXd& lambda() const override;
  double promised_error() const override { return 1e-12; }
  std::string setting() const override;

 private:
  static std::vector<Water> waters_in(const System& sys);

  LaneBatches<Batch> batches_;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
