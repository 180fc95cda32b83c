#pragma once

#include <algorithm>
#include <memory>

#include "constraints/batch/multiplier_history.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "lammps/box_motion.hpp"
#include "lammps/local_system.hpp"

namespace taut {

// The bonds of one processor as a system of their own, in LAMMPS's units, solved by a method of
// `constraints`.
//
// feedforward needs of its atoms where they would go without constraint forces, δ = h v + κ M⁻¹f with κ = h²
// (the first time ½h²): it is given v = δ/h and no forces, and what comes out are the constraint forces. With
// other gains Baumgarte's law needs v and f, since it asks where bonds came from, too.
//
// A bond that ends where this processor's part does is pulled on by the next bond beyond, with λ r: its
// multiplier is a guess from what its own processor has found in the steps before.
class LocalSolve {
 public:
  LocalSolve(LocalSystem local, const MethodOptions& method, double h);

  const System& system() const { return local_.system; }
  const LocalSystem& local() const { return local_; }
  LocalSystem& local() { return local_; }
  State& state() { return s_; }
  bool feedforward() const { return feedforward_; }
  const Vectors& outer_r() const { return outer_r_; }
  const Eigen::VectorXd& lambda() const { return method_->lambda(); }
  double promised_error() const { return method_->promised_error(); }

  // The past of multipliers, from the atoms and to them. `known`: how many steps of it count.
  void load_past(int known);
  void keep_past();
  // What ghosts are told of the bonds: the newest multipliers, of the past, or as just found, of local().told alone.
  void tell_past();
  void tell_newest();
  int steps_kept() const { return history_->steps_kept(); }
  int steps_known() const { return history_->steps_known(); }

  // x of the images, in a box.
  void load_positions(double** x, const LAMMPS_NS::Domain& box);
  // The pull of bonds beyond, with multipliers as guessed or received, on what the method is given: all of it after
  // motions were read, then what multipliers have changed since.
  void motions_were_read() { std::ranges::fill(pulled_, 0); }
  void add_outer_pull(double kick);
  // Multipliers beyond: the past's next value. The last one, the line or the
  // parabola through the last two or three, by order.
  void guess_outer(int order);

  SolveStats step() { return method_->add_forces(local_.system, Push::between_steps(h_), s_); }
  SolveStats again() { return history_->again(local_.system, Push::between_steps(h_), s_); }
  SolveStats start() { return method_->add_forces(local_.system, Push::at_start(h_), s_); }

  // |σ|/d² of the coming step, at most, if the constraint forces are Jᵀλ of the past.
  double error_ahead(double kick) const;
  // |σ|/d², at most; and x to where it is none. Throws SimulationFailure.
  double error_now() const;
  void project_positions() { Projector(local_.system).positions(local_.system, s_.x); }
  // f += Jᵀλ of the past.
  void add_past_forces();

  // Takes the velocities' part along the bonds, M⁻¹Jᵀμ, out: at once; or at the start, where bonds beyond
  // have a μ of their own (outer_lambda), and μ is what ghosts are told.
  SolveStats project_velocities();
  SolveStats project_velocities_at_start();

  std::vector<double> outer_lambda;  // of local().outer

 private:
  LocalSystem local_;
  double h_;
  bool feedforward_;
  std::unique_ptr<ConstraintMethod> method_, projection_;
  std::unique_ptr<DirectSolver> direct_;  // for velocities at the start
  MultiplierHistory* history_;
  State s_;
  Eigen::MatrixXd past_;        // m × steps kept
  Vectors outer_r_;             // from the inner atom to the outer
  std::vector<double> pulled_;  // outer multipliers whose pull has been added
};

}  // namespace taut
