#pragma once

#include <limits>
#include <string>

#include "base/archive.hpp"
#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// An algorithm that holds the bonds. It acts in up to three stages of the step (md/step.hpp), all empty here:
// this one holds nothing.
class ConstraintMethod {
 public:
  virtual ~ConstraintMethod() = default;

  // x is drifted by h·v, so x − hv are the positions before. May move x, and v by the same over h.
  virtual SolveStats project_positions(const System&, double /*h*/, State&) { return {}; }
  // v is the half-step velocity, f the force at x. May add Jᵀλ to f.
  virtual SolveStats add_forces(const System&, double /*h*/, State&) { return {}; }
  // v is the full-step velocity. May take its part along the bonds out.
  virtual SolveStats project_velocities(const System&, double /*h*/, State&) { return {}; }

  // Before the first step: as add_forces, but v is the full-step velocity, and nothing of the past is known.
  virtual SolveStats start(const System&, State&) { return {}; }

  // λ of the last step, one a bond: f_c = Jᵀλ.
  virtual const Eigen::VectorXd& lambda() const {
    static const Eigen::VectorXd kNone;
    return kNone;
  }
  // The relative bond error it answers for.
  virtual double promised_error() const { return std::numeric_limits<double>::infinity(); }
  // Gains, tolerance, ... in one line.
  virtual std::string setting() const { return ""; }
  // What it takes from one step to the next.
  virtual void serialize(Archive&) {}

  enum class Holds {
    kAll,        // lengths, and velocities along the tangent
    kPositions,  // the velocities at full steps keep a part along the bonds
    kSprings,    // none: bonds swing
  };
  virtual Holds holds() const { return Holds::kAll; }
  virtual double spring_energy(const System&, const Vectors& /*x*/) const { return 0; }  // [kJ/mol]
};

}  // namespace taut
