#pragma once

#include <vector>

#include "constraints/direct_solver.hpp"
#include "md/solve_stats.hpp"

namespace taut {

// A one-sided bond's multiplier on the side that it may have: a strut pushes, a rope pulls.
inline double one_sided(int side, double lambda) {
  return side == 0 || side * lambda > 0 ? lambda : 0;
}

// Bonds and one-sided bonds at once: with s = 1 of a strut, −1 of a rope, and w = Aλ − b,
//     w = 0 on bonds;     sλ ≥ 0, sw ≥ 0, λw = 0 on one-sided ones,
// the conditions of the least ½λᵀAλ − bᵀλ with sλ ≥ 0, by the active set of Lawson and Hanson (Solving Least
// Squares Problems, 1974, doi:10.1137/1.9781611971217, 23.10; in terms of A: Bro and De Jong 1997,
// doi:10.1002/(SICI)1099-128X(199709/10)11:5<393::AID-CEM483>3.0.CO;2-L). Those that act are guessed and
// solved for as bonds are. Then the idle one that is most wrong joins, and on the way to the new solution
// those leave whose λ gets to 0. What joins depends on none that act (their w is 0, its is not): A stays
// regular however many touch, and the way ends. Differs: who acts is guessed from the λ of the step before.
// Cost: a factorization and a solve a change; mostly one, where the guess holds.
class ActiveSet {
 public:
  explicit ActiveSet(const System& sys);

  // λ: the guess, whose signs say who acts, and the answer. r: of all bonds; 0: left out.
  Failure solve(const System& sys, const Vectors& r, const Eigen::VectorXd& b, Eigen::VectorXd& lambda);
  int blamed() const { return blamed_; }  // the bond that could not be held, of a failure

 private:
  void solve_acting(const Vectors& r, const Eigen::VectorXd& b);
  bool drop_guesses(const System& sys);
  int most_wrong(const System& sys, const Vectors& r, const Eigen::VectorXd& b);
  void go_as_far_as_allowed(const System& sys, Eigen::VectorXd& lambda);

  DirectSolver solver_;
  Vectors acting_;          // r of those that act
  Vectors y_;               // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd target_;  // λ as if those that act were bonds
  std::vector<char> acts_;
  int blamed_ = -1;
};

}  // namespace taut
