#include "simulation/minimise.hpp"

#include <cmath>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "constraints/projection.hpp"
#include "forcefield/check_positions.hpp"
#include "forcefield/force_field.hpp"

namespace taut {
namespace {

constexpr double kShortestMove = 1e-9;  // [nm]

System with_unit_masses(System sys) {
  sys.mass = sys.mass.unaryExpr([](double m) { return m > 0 ? 1.0 : 0.0; });
  sys.inv_mass = sys.mass;
  return sys;
}

double largest(const Vectors& f) {
  return f.cols() > 0 ? std::sqrt(f.colwise().squaredNorm().maxCoeff()) : 0.0;
}

class Descent {
 public:
  Descent(const System& sys, ForceField& forces, const State& start)
      : real_(sys), sys_(with_unit_masses(sys)), forces_(forces), projector_(sys_) {
    here_ = start;
    projector_.positions(sys_, here_.x);
    energy_ = evaluate(here_);
    if (!std::isfinite(energy_) || !here_.f.allFinite()) {
      refuse_atoms_in_one_place(here_.box, here_.x);
      throw SimulationFailure("run.minimise: the energy of the start is no number");
    }
    next_ = here_;
  }

  // Moves the atom of the largest force by `length`. False where that does not lower the energy.
  bool move(double length) {
    next_.x = here_.x + length / largest(here_.f) * here_.f;
    double energy = 0;
    try {
      projector_.positions(sys_, next_.x);
      energy = evaluate(next_);
    } catch (const OwnCodeFailure&) {
      throw;
    } catch (const SimulationFailure&) {
      return false;  // too far for the bonds to be brought back, or beyond a wall or the end of a table
    }
    if (!(energy < energy_) || !next_.f.allFinite()) return false;
    std::swap(here_, next_);
    energy_ = energy;
    return true;
  }

  double force() const { return largest(here_.f); }
  double energy() const { return energy_; }
  const Vectors& x() const { return here_.x; }

 private:
  // The energy; f becomes tangent.
  double evaluate(State& s) {
    const double energy = forces_.evaluate_energy(real_, s);
    hear();
    for (int a = 0; a < sys_.atoms(); ++a) s.f.col(a) *= sys_.mass[a];  // an anchor's force moves nothing
    projector_.velocities(sys_, s.x, s.f);
    return energy;
  }

  const System& real_;
  System sys_;  // of unit masses
  ForceField& forces_;
  Projector projector_;
  State here_, next_;  // f: the tangent force
  double energy_ = 0;
};

}  // namespace

Minimised minimise(const System& sys, ForceField& forces, const MinimiseGoal& goal, State& s,
                   const OnMove& on_move) {
  Descent descent(sys, forces, s);
  Minimised result{.energy_before = descent.energy()};
  const auto note = [&] { result.energy = descent.energy(), result.largest_force = descent.force(); };
  note();
  double length = 0.2 * kLongestMove;
  while (result.largest_force > goal.force && length > kShortestMove && result.moves < goal.most_moves) {
    if (on_move) on_move(result);
    ++result.moves;
    length = descent.move(length) ? std::min(1.2 * length, kLongestMove) : 0.5 * length;
    note();
  }
  s.x = descent.x();
  return result;
}

}  // namespace taut
