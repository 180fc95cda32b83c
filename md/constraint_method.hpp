#pragma once

#include <limits>
#include <string>

#include "base/archive.hpp"
#include "md/solve_stats.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// How the forces at x move the atoms to where forces act next:
//     v_next = v + kick M⁻¹(f + noise),   x_next = x + h v_next.
// Between two steps v is the half-step velocity, and the forces act in the second half of one step and the first
// half of the next. At the start v is the full-step velocity, and they act in the first half alone.
struct Push {
  double h;                        // length of the step to come [ps]
  double kick;                     // how long the forces act: h, and ½h at the start [ps]
  const Vectors* noise = nullptr;  // the random force of a thermostat, no part of f [kJ/mol/nm]; null: none
  // Of anchors that move, (v_next − v)/kick, and 0 of all other atoms [nm/ps²]; null: all anchors stand.
  const Vectors* prescribed = nullptr;

  static Push between_steps(double h) { return {h, h}; }
  static Push at_start(double h) { return {h, 0.5 * h}; }
  bool starts() const { return kick < h; }
  double last_h() const {
    return 2 * kick - h;
  }                                           // length of the step that ended at x: h, 0 at the start [ps]
  double h_kick() const { return h * kick; }  // x_next = x + h v + h_kick M⁻¹(f + noise) [ps²]
  Vec3 force(const Vectors& f, int atom) const {  // f + noise on an atom [kJ/mol/nm]
    return noise ? Vec3(f.col(atom) + noise->col(atom)) : Vec3(f.col(atom));
  }
  Vec3 acceleration(const System& sys, const Vectors& f, int atom) const {  // [nm/ps²]
    const Vec3 a = sys.inv_mass[atom] * force(f, atom);
    return prescribed ? Vec3(a + prescribed->col(atom)) : a;
  }
};

// An algorithm that holds the bonds. It acts in up to three stages of the step (md/velocity_verlet.hpp), all empty here:
// this one holds nothing.
class ConstraintMethod {
 public:
  virtual ~ConstraintMethod() = default;

  // x is drifted by h·v, so x − hv are the positions before. May move x, and v by the same over h.
  virtual SolveStats project_positions(const System&, double /*h*/, State&) { return {}; }
  // f is the force at x; `push` says how it acts. May add Jᵀλ to f. It is called once before the first step, too.
  virtual SolveStats add_forces(const System&, const Push& /*push*/, State&) { return {}; }
  // v is the full-step velocity. May take its part along the bonds out.
  virtual SolveStats project_velocities(const System&, double /*h*/, State&) { return {}; }

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
